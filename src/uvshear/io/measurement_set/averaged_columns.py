"""Columns with which rows that are averages over cells of (u, v, w) describe their samples."""

from typing import Final

import numpy as np
from casacore import tables

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.interferometer.averaged_rows import AveragedRows
from uvshear.typing import Array, Float

FREQUENCY: Final = "UVSHEAR_FREQUENCY"
"""Mean frequency [Hz]."""

WIDTH: Final = "UVSHEAR_WIDTH"
"""Mean of Δν/ν of the samples times their mean frequency [Hz]."""

SECOND: Final = "UVSHEAR_SECOND"
"""Second moments of the samples' UVW about that of the row: uu, uv, uw, vv, vw, ww [m^2]."""

FOURTH: Final = "UVSHEAR_FOURTH"
"""Coefficients of the loss beyond them: uuuu, uuuv, uuuw, uuvv, uuvw, uuww, uvvv, uvvw, uvww, uwww, vvvv, vvvw, vvww,
vwww, wwww [m^4]."""


SHAPES: Final[dict[str, tuple[int, ...]]] = {FREQUENCY: (), WIDTH: (), SECOND: (6,), FOURTH: (15,)}
"""Shape of the value of each column."""

KEYWORD: Final = "UVSHEAR_AVERAGE"
"""Keyword of the main table with the sizes of the cells, UV and W [wavelengths]."""


def has_averages(main: tables.table) -> bool:
    """Tell whether the rows of a set are such averages."""
    return {FREQUENCY, WIDTH, SECOND, FOURTH} <= set(main.colnames())


def read_averages(main: tables.table, start: int, count: int, frequency: float) -> AveragedRows:
    """Read the columns of some rows, whose UVW is in metres at this frequency [Hz]."""
    mean, width, second, fourth = (
        _numbers(main, name, start, (count, *shape)) for name, shape in SHAPES.items()
    )
    size = cell_size(main) * (SPEED_OF_LIGHT / frequency)
    return AveragedRows(mean, width, second, fourth, size)


def _numbers(
    main: tables.table, name: str, start: int, shape: tuple[int, ...]
) -> Float[Array, " *_"]:
    values = np.asarray(main.getcol(name, start, shape[0]))
    if values.dtype.kind != "f" or values.shape != shape:
        raise InputError(
            f"{main.name()}: the column {name} has {values.dtype} numbers of shape {values.shape[1:]}, not floats of"
            f" shape {shape[1:]}"
        )
    return values


def cell_size(main: tables.table) -> Float[Array, " 3"]:
    """Read the sizes of the cells along u, v and w [wavelengths]."""
    try:
        sizes = main.getkeyword(KEYWORD)
        found = np.array([float(sizes[name]) for name in ("UV", "UV", "W")])
    except (RuntimeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{main.name()}: no sizes of cells in the keyword {KEYWORD}") from error
    if not (np.isfinite(found) & (found > 0)).all():
        raise InputError(
            f"{main.name()}: the keyword {KEYWORD} gives cells of {found[0]:g} x {found[2]:g} wavelengths"
        )
    return found
