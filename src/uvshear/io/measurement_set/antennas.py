"""The antennas of a Measurement Set: their positions and dishes, so far as they are known."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.errors import InputError
from uvshear.io.measurement_set.opening import casacore_errors, open_table
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class KnownAntennas:
    """Antennas of a set, in the order of their numbers.

    Parameters
    ----------
    positions
        Geocentric positions [m]; NaN where they are not filled.
    diameters
        Diameters of the dishes [m]; 0 where they are not known.
    is_readable
        Whether the table of antennas could be read; if not, there are none, and visibilities are used without them.
    """

    positions: Float[Array, "antenna 3"] = field(default_factory=lambda: np.zeros((0, 3)))
    diameters: Float[Array, " antenna"] = field(default_factory=lambda: np.zeros(0))
    is_readable: bool = True


def read_antennas(path: Path) -> KnownAntennas:
    """Read the table ANTENNA."""
    try:
        with open_table(path, "ANTENNA") as table, casacore_errors(path, "ANTENNA"):
            return _read(table)
    except InputError:
        return KnownAntennas(is_readable=False)


def _read(table: tables.table) -> KnownAntennas:
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
    return KnownAntennas(positions, diameters)
