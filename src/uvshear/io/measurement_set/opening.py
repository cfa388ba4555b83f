"""Tables of a Measurement Set, opened for reading without waiting for other processes."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from casacore import tables

from uvshear.errors import InputError
from uvshear.io.measurement_set.termination import told_if_terminated

WITHOUT_LOCK: Final = "autonoread"
"""Lock option of casacore with which reading needs no lock. With a lock, casacore would wait for as long as another
process has the set open for writing, and could not be interrupted."""


NO_STORAGE_MANAGER: Final = (
    re.compile(r"Shared library (\w+) not found"),
    re.compile(r"Data Manager class (\S+) is not registered"),
)
"""casacore's error messages about a storage manager that is not installed. In the first, its name is in lower case."""


@contextmanager
def casacore_errors(path: Path, what: str) -> Iterator[None]:
    """Turn casacore's own errors into one line."""
    try:
        with told_if_terminated(path, what):
            yield
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: {what} has text that is not UTF-8; it is damaged") from error
    except (RuntimeError, OSError) as error:
        reason = " ".join(str(error).split())
        for words in NO_STORAGE_MANAGER:
            if (found := words.search(reason)) is not None:
                raise InputError(_no_storage_manager(path, what, found[1])) from error
        raise InputError(f"{path}: {what} cannot be read ({reason})") from error


def _no_storage_manager(path: Path, what: str, name: str) -> str:
    """Say what to do about a table whose storage manager is not installed, with its name as table.dat spells it."""
    try:
        known = re.search(rf"(?i){re.escape(name)}\b".encode(), (path / "table.dat").read_bytes())
    except OSError:
        known = None
    called = name if known is None else known[0].decode()
    return (
        f"{path}: {what} has columns in {called}, a storage manager that is not part of this casacore; rewrite the set"
        f" where it is installed, for example with DP3 msin={path.name} msout=PLAIN.ms steps=[] msout.storagemanager="
    )


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
