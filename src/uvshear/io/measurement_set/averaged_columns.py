"""Columns with which rows that are averages over cells of (u, v, w) describe their samples."""

from typing import Final

import numpy as np
from casacore import tables

from uvshear.interferometer.averaged_rows import AveragedRows

FREQUENCY: Final = "UVSHEAR_FREQUENCY"
"""Mean frequency [Hz]."""

WIDTH: Final = "UVSHEAR_WIDTH"
"""Mean of Δν/ν of the samples times their mean frequency [Hz]."""

SECOND: Final = "UVSHEAR_SECOND"
"""Second moments of the samples' UVW about that of the row: uu, uv, uw, vv, vw, ww [m^2]."""

FOURTH: Final = "UVSHEAR_FOURTH"
"""Coefficients of the loss beyond them: uuuu, uuuv, uuuw, uuvv, uuvw, uuww, uvvv, uvvw, uvww, uwww, vvvv, vvvw, vvww,
vwww, wwww [m^4]."""


def has_averages(main: tables.table) -> bool:
    """Tell whether the rows of a set are such averages."""
    return {FREQUENCY, WIDTH, SECOND, FOURTH} <= set(main.colnames())


def read_averages(main: tables.table, start: int, count: int) -> AveragedRows:
    """Read the columns of some rows."""
    return AveragedRows(
        *(
            np.asarray(main.getcol(name, start, count))
            for name in (FREQUENCY, WIDTH, SECOND, FOURTH)
        )
    )
