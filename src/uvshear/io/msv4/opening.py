"""Groups of an MSv4 store, opened with xarray, which is imported only here."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any, TypeAlias

from uvshear.errors import InputError

Dataset: TypeAlias = Any
"""An ``xarray.Dataset``; xarray is an optional dependency."""


@contextmanager
def zarr_errors(place: Path, what: str) -> Iterator[None]:
    """Turn the errors of xarray, zarr and their codecs, which are of many types, into one line."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{place}: {what} cannot be read ({reason})") from error


@contextmanager
def open_group(group: Path) -> Iterator[Dataset]:
    """Open a group for reading, and close it; arrays are read when they are sliced.

    Consolidated metadata are not used: a store need not have them, and they may be out of date.
    """
    xarray = _xarray(group)
    with zarr_errors(group, "the group"):
        # Times are numbers of seconds in the schema, and are to stay numbers.
        opened = xarray.open_dataset(
            group,
            engine="zarr",
            consolidated=False,
            chunks=None,
            cache=False,
            decode_times=False,
            decode_timedelta=False,
        )
    try:
        yield opened
    finally:
        opened.close()


def _xarray(group: Path) -> ModuleType:
    try:
        import xarray  # noqa: PLC0415
        import zarr  # noqa: F401, PLC0415
    except ImportError as error:
        raise InputError(
            f"{group}: an MSv4 store is read with the packages xarray and zarr, of which one is missing"
            f" ({error}); they come with pip install 'uvshear[msv4]'"
        ) from error
    return xarray
