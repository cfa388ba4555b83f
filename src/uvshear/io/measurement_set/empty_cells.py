"""Cells of a table to which nothing was ever written: casacore ends the process when it is asked for their values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.errors import InputError
from uvshear.typing import Array, Int


@dataclass(frozen=True)
class EmptyCells:
    """Rows of a table that have no value in a column.

    Parameters
    ----------
    rows
        Numbers of these rows by column; columns that have all values are left out.
    """

    rows: Mapping[str, Int[Array, " row"]]

    def check(self, path: Path, wanted: Int[Array, " row"]) -> None:
        """Refuse rows that are to be read if any of them has no value.

        Parameters
        ----------
        path
            Path of the set.
        wanted
            Numbers of the rows.
        """
        for column, empty in self.rows.items():
            lacking = np.intersect1d(empty, wanted)
            if len(lacking):
                raise InputError(
                    f"{path}: column {column} has no value in {len(lacking)} rows, the first of which is row"
                    f" {lacking[0]}; the set was not written completely"
                )


def rows_without_value(main: tables.table, columns: Sequence[str]) -> EmptyCells:
    """Find the rows without a value; columns of a fixed shape have all values."""
    found = {column: _rows(main, column) for column in columns if main.isvarcol(column)}
    return EmptyCells({column: rows for column, rows in found.items() if len(rows)})


def _rows(main: tables.table, column: str) -> Int[Array, " row"]:
    try:
        # 10 ns for each row
        rows = main.query(f"!isdefined({column})").rownumbers()
    except RuntimeError:
        # casacore's query language refuses columns whose unit it does not know, such as "uncalib"; 300 ns for each row
        rows = [row for row in range(main.nrows()) if not main.iscelldefined(column, row)]
    return np.asarray(rows, dtype=np.int64)
