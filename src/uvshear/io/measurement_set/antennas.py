"""The antennas of a Measurement Set: their positions and dishes, so far as they are known."""

from pathlib import Path

import numpy as np

from uvshear.io.measurement_set.opening import open_table
from uvshear.typing import Array, Float


def read_antennas(path: Path) -> tuple[Float[Array, "antenna 3"], Float[Array, " antenna"]]:
    """Return the position [m] and the diameter of the dish [m] of each antenna.

    Positions that are not filled are NaN, and diameters that are not known 0: visibilities can be used without them.
    """
    with open_table(path, "ANTENNA") as table:
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
