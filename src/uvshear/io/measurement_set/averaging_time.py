"""The time that each row of a Measurement Set was averaged over."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from casacore import tables

from uvshear.io.measurement_set.opening import casacore_errors
from uvshear.typing import Array, Float

TOLERANCE: Final = 0.01
"""Relative difference that is attributed to rounding."""

ROWS_COMPARED: Final = 2**20
"""Number of rows whose EXPOSURE is compared with INTERVAL."""


def averaging_time(
    path: Path, main: tables.table, start: int, count: int, *, is_averaged: bool
) -> Float[Array, " row"]:
    """Return EXPOSURE [s], or INTERVAL in a set without it; 0 in a set that has neither.

    Parameters
    ----------
    path
        Path of the set.
    main
        The main table, or a selection of its rows.
    start, count
        Rows to read.
    is_averaged
        Whether the channels of these rows are averages. The visibilities are then averages over time as well, so that
        an EXPOSURE of 0 was not filled. INTERVAL is taken instead of an EXPOSURE that is 0, negative or not finite.
    """
    columns = [name for name in ("EXPOSURE", "INTERVAL") if name in main.colnames()]
    if not columns:
        return np.zeros(count)
    time = _read(path, main, columns[0], start, count)
    is_lacking = ~(np.isfinite(time) & (time > 0))
    if is_averaged and len(columns) > 1 and np.any(is_lacking):
        return np.where(is_lacking, _read(path, main, columns[1], start, count), time)
    return time


def averaging_notice(main: tables.table, rows: Sequence[int], *, is_averaged: bool) -> str | None:
    """Return what a user should know about the averaging times of a set, judged by some of its rows.

    Parameters
    ----------
    main
        The main table.
    rows
        Rows to look at.
    is_averaged
        Whether any channels of the set are averages.
    """

    def is_filled(name: str) -> bool:
        return name in columns and any(main.getcell(name, row) != 0 for row in rows)

    columns = main.colnames()
    if "EXPOSURE" not in columns and is_filled("INTERVAL"):
        return "there is no column EXPOSURE; visibilities are taken to be averages over INTERVAL"
    if not is_averaged or is_filled("EXPOSURE"):
        return None
    if not is_filled("INTERVAL"):
        return (
            "the channels are averages, but no row has an EXPOSURE or an INTERVAL; smearing in time is not in the"
            " model"
        )
    return "EXPOSURE is 0 although the channels are averages; visibilities are taken to be averages over INTERVAL"


def rows_beyond_interval(main: tables.table) -> int:
    """Count the rows, among the first million, whose EXPOSURE is longer than INTERVAL, which it cannot exceed."""
    if not {"EXPOSURE", "INTERVAL"} <= set(main.colnames()):
        return 0
    exposure, interval = (
        np.asarray(main.getcol(name, 0, ROWS_COMPARED), float) for name in ("EXPOSURE", "INTERVAL")
    )
    return int(np.count_nonzero((interval > 0) & (exposure > (1 + TOLERANCE) * interval)))


def _read(
    path: Path, main: tables.table, column: str, start: int, count: int
) -> Float[Array, " row"]:
    with casacore_errors(path, f"column {column}"):
        return np.asarray(main.getcol(column, start, count), float)
