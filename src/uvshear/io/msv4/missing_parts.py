"""Parts of the visibilities that are not in an MSv4 store, as after a copy that was interrupted."""

from pathlib import Path

from uvshear.io.msv4.opening import zarr_errors


def missing_parts(group: Path, name: str) -> tuple[int, int]:
    """Return how many of the parts of a variable have no file, and how many parts there are.

    A writer leaves out parts in which everything has the value that stands for no data. For visibilities this is 0,
    which no part that was observed has everywhere.
    """
    import zarr  # noqa: PLC0415

    with zarr_errors(group, name):
        array = zarr.open_array(group / name, mode="r")
        return array.nchunks - array.nchunks_initialized, array.nchunks
