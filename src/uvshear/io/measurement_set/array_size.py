"""The longest baseline that the antennas of a Measurement Set can have."""

from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.interferometer.array_extent import ROWS_COMPARED, array_extent
from uvshear.io.measurement_set.antennas import read_antennas


def longest_baseline(path: Path, main: tables.table) -> float | None:
    """Return a length that no baseline exceeds [m]; None where the positions of the antennas do not fit to UVW."""
    positions, diameters = read_antennas(path)
    rows = np.unique(np.linspace(0, main.nrows() - 1, ROWS_COMPARED).astype(int))
    chosen = main.selectrows(rows)
    antennas = np.column_stack([chosen.getcol("ANTENNA1"), chosen.getcol("ANTENNA2")])
    return array_extent(positions, diameters, antennas, np.asarray(chosen.getcol("UVW"), float))
