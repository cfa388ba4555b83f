"""casacore's tables while they are written."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager

from casacore import tables


@contextmanager
def written(table: tables.table) -> Iterator[tables.table]:
    """Yield a table, which is closed at the end of the block; if it cannot be written, it is left open for ever.

    casacore writes what it holds in memory when the object of a table is deleted. Where that fails again, as on a full
    disk or in a directory that has been removed, it ends the process.
    """
    try:
        yield table
        # A failure of flush is an exception; one of close ends the process.
        table.flush(recursive=True)
        table.close()
    except BaseException:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(table))
        raise
