"""The antennas of a Measurement Set: their positions and dishes, so far as they are known."""

from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.errors import InputError
from uvshear.io.measurement_set.opening import casacore_errors, open_table
from uvshear.typing import Array, Float


def read_antennas(path: Path) -> tuple[Float[Array, "antenna 3"], Float[Array, " antenna"]]:
    """Return the position [m] and the diameter of the dish [m] of each antenna.

    Positions that are not filled are NaN, and diameters that are not known 0. A table that cannot be read has no
    antennas. Visibilities can be used without them.
    """
    try:
        with open_table(path, "ANTENNA") as table, casacore_errors(path, "ANTENNA"):
            return _read(table)
    except InputError:
        return np.zeros((0, 3)), np.zeros(0)


def _read(table: tables.table) -> tuple[Float[Array, "antenna 3"], Float[Array, " antenna"]]:
    count = table.nrows()
    positions, diameters = np.full((count, 3), np.nan), np.zeros(count)
    columns = table.colnames()
    for row in range(count):
        if "POSITION" in columns and table.iscelldefined("POSITION", row):
            place = np.asarray(table.getcell("POSITION", row))
            if place.shape == (3,) and place.dtype.kind in "fiu":
                positions[row] = place
        if "DISH_DIAMETER" in columns and table.iscelldefined("DISH_DIAMETER", row):
            diameter = np.asarray(table.getcell("DISH_DIAMETER", row))
            if diameter.shape == () and diameter.dtype.kind in "fiu":
                diameters[row] = diameter
    return positions, diameters
