"""Tables of a Measurement Set, opened for reading without waiting for other processes."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from casacore import tables

from uvshear.errors import InputError

WITHOUT_LOCK: Final = "autonoread"
"""Way of opening that needs no lock to read. With a lock, casacore would wait for as long as another process has the
set open for writing, and could not be interrupted."""


@contextmanager
def casacore_errors(path: Path, what: str) -> Iterator[None]:
    """Turn casacore's own errors into one line."""
    try:
        yield
    except (RuntimeError, OSError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{path}: {what} cannot be read ({reason})") from error


@contextmanager
def open_table(path: Path, subtable: str = "") -> Iterator[tables.table]:
    """Open for reading, and close.

    A subtable is found through the keyword of the main table that refers to it, as it need not lie within the set: a
    selection of rows refers to the subtables of the set that it selects from.
    """
    name = f"{path}::{subtable}" if subtable else str(path)
    with casacore_errors(path, f"the {subtable or 'main'} table"):
        opened = tables.table(name, ack=False, lockoptions=WITHOUT_LOCK)
    try:
        yield opened
    finally:
        opened.close()
