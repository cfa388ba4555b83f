"""Checks of a table of shapes that was read from a file."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from astropy.table import Column, Table

from uvshear.errors import InputError
from uvshear.shapes.measurement import FitFlag
from uvshear.typing import Array, Float, Shaped

LIMITS: Final[Mapping[str, tuple[float, float]]] = {
    "l": (-1, 1),
    "m": (-1, 1),
    "e1": (-1, 1),
    "e2": (-1, 1),
    "e_sigma": (0, 1e6),
    "weight": (0, 1e6),
    "flux": (-1e15, 1e15),
    "snr": (-1e15, 1e15),
    "detection": (-1e15, 1e15),
}
"""Smallest and largest numbers of the columns from which a shear is estimated, in the units of files."""

ALWAYS: Final = ("l", "m", "weight")
"""Columns with a number for every source."""

MEASURED: Final = ("e1", "e2", "e_sigma", "snr")
"""Columns with a number for every source that is measured."""


NEEDED: Final = ("e1", "e2", "e_sigma", "weight", "snr")
"""Columns without which no shear can be estimated."""


def check_shapes(table: Table, name: str) -> None:
    """Refuse a table whose cells are not those of a table of shapes; messages call it by its name.

    Raises
    ------
    InputError
        A column is missing or holds something else than numbers or words, a number is missing or out of its range, or
        a flag is not one of ``shapes.measurement.FitFlag``.
    """
    for column in (*NEEDED, "flag"):
        if column not in table.colnames:
            raise InputError(
                f"{name}: has no column '{column}'; a table written by `uvshear measure` is needed"
            )
    flags = as_words(table["flag"], f"{name}: column 'flag'")
    known = {flag.word for flag in FitFlag}
    _require(name, "flag", np.isin(flags, sorted(known)), "the word of a flag is needed", flags)
    is_measured = flags == FitFlag.OK.word
    for column in LIMITS:
        if column in table.colnames:
            values = numbers(table[column], f"{name}: column '{column}'")
            low, high = LIMITS[column]
            good = (values >= low) & (values <= high)
            if column not in ALWAYS:
                good |= np.isnan(values) & ~(is_measured & (column in MEASURED))
            _require(name, column, good, f"a number between {low:g} and {high:g} is needed", values)
    if {"l", "m"} <= set(table.colnames):
        l, m = (numbers(table[column], name) for column in ("l", "m"))
        _require(name, "l", np.hypot(l, m) <= 1, "l^2 + m^2 must be 1 or less", l)


def numbers(column: Column, where: str) -> Float[Array, " source"]:
    """Return a column of numbers, NaN where it is empty; messages call it as ``where`` does."""
    if column.dtype.kind not in "fiu":
        raise InputError(f"{where}: holds no numbers; numbers are needed")
    if column.ndim != 1:
        raise InputError(f"{where}: holds arrays; one number for each row is needed")
    filled: Array = np.ma.filled(np.ma.asarray(column, dtype=float), np.nan)
    return filled


def as_words(column: Column, where: str = "a column of words") -> Shaped[Array, " source"]:
    """Return a column of words without blanks around them, empty where the table has none."""
    if column.ndim != 1 or column.dtype.kind not in "SUO":
        raise InputError(f"{where}: holds no words; one word for each row is needed")
    try:
        # FITS has bytes.
        words: Array = np.ma.filled(np.ma.asarray(column).astype(str), "")
    except UnicodeDecodeError:
        raise InputError(f"{where}: has letters beyond ASCII; words are needed") from None
    return np.char.strip(words)


def _require(
    name: str, column: str, good: Array, needed: str, values: Shaped[Array, " source"]
) -> None:
    """Raise an error that names the first row that is not valid."""
    if not np.all(good):
        row = int(np.argmin(good))
        value = values[row]
        shown = f"{value:g}" if isinstance(value, float) else repr(str(value))
        raise InputError(f"{name}: column '{column}', row {row + 1}: is {shown}; {needed}")
