"""Zarr chunks of visibilities that are missing in an MSv4 store, as after a copy that was interrupted."""

from pathlib import Path

from uvshear.io.msv4.opening import zarr_errors


def missing_parts(group: Path, name: str) -> tuple[int, int]:
    """Return how many of the zarr chunks of a variable have no file, and how many chunks there are.

    Writers leave out a chunk in which every value is the fill value. For visibilities this is 0, and no chunk that was
    observed is 0 everywhere.
    """
    import zarr  # noqa: PLC0415

    with zarr_errors(group, name):
        array = zarr.open_array(group / name, mode="r")
        return array.nchunks - array.nchunks_initialized, array.nchunks
