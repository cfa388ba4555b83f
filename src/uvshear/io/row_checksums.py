"""Checksums of the rows of a table, by which a number that was changed after the writing is found."""

import zlib
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from astropy.table import Column, Table

from uvshear.typing import Array, Bool, Int

CHECKSUM: Final = "checksum"
"""Name of the column, which covers the columns before it; whoever adds columns may do so behind it."""


def checksums(table: Table) -> Column:
    """Return the CRC-32 of each row of a table, as a column."""
    return Column(
        _sums(table, table.colnames),
        name=CHECKSUM,
        description="CRC-32 of the row's cells in the columns before this one",
    )


def changed_rows(table: Table) -> Bool[Array, " row"]:
    """Tell which rows of a table are not as they were when their checksums were taken; none in a table without."""
    if CHECKSUM not in table.colnames:
        return np.zeros(len(table), bool)
    covered = table.colnames[: table.colnames.index(CHECKSUM)]
    stored = np.ma.filled(np.ma.asarray(table[CHECKSUM]), -1)
    if stored.shape != (len(table),):
        return np.ones(len(table), bool)
    changed: Bool[Array, " row"] = stored != _sums(table, covered)
    return changed


def _sums(table: Table, names: Sequence[str]) -> Int[Array, " row"]:
    sums = [0] * len(table)
    for name in names:
        column = table[name]
        cells = (
            np.ma.filled(column, np.nan)
            if isinstance(column, np.ma.MaskedArray) and column.dtype.kind == "f"
            else column
        )
        sums = [zlib.crc32(_bytes(cell), so_far) for so_far, cell in zip(sums, cells, strict=True)]
    return np.array(sums, dtype=np.int64)


def _bytes(cell: Any) -> bytes:
    """Return the content of a cell, however a file holds it: text without padding, numbers in double precision."""
    values = np.asarray(cell)
    if values.dtype.kind in "USO":
        return " ".join(map(_word, values.ravel().tolist())).encode()
    numbers = np.ravel(values).astype(">f8")
    # There are several NaNs, which some writers exchange.
    return np.where(np.isnan(numbers), np.nan, numbers).astype(">f8").tobytes()


def _word(value: object) -> str:
    return (value.decode(errors="replace") if isinstance(value, bytes) else str(value)).rstrip()
