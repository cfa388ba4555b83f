"""The longest baseline that the antennas of a Measurement Set can have."""

from pathlib import Path
from typing import Final

import numpy as np
from casacore import tables

from uvshear.interferometer.primary_beam import LARGEST_DISH
from uvshear.interferometer.screening import LONGEST_BASELINE
from uvshear.io.measurement_set.antennas import read_antennas

ROWS_COMPARED: Final = 256
"""Number of rows, spread over the set, whose UVW is compared with the antennas' positions."""

TOLERANCE: Final = 0.01
"""Relative difference between the length of UVW and the distance of two antennas that is taken as agreement. Geodesy,
aberration and averaging make less than 1e-3."""


def longest_baseline(path: Path, main: tables.table) -> float | None:
    """Return a length that no baseline exceeds [m]: that of the array, and one per cent, and one dish.

    The result is None unless most of the compared rows have a UVW as long as the distance of their antennas: positions
    may be missing, or refer to another frame.
    """
    positions, diameters = read_antennas(path)
    if len(positions) < 2:
        return None
    rows = np.unique(np.linspace(0, main.nrows() - 1, ROWS_COMPARED).astype(int))
    chosen = main.selectrows(rows)
    first, second = (np.asarray(chosen.getcol(name), int) for name in ("ANTENNA1", "ANTENNA2"))
    uvw = np.asarray(chosen.getcol("UVW"), float)
    known = (np.minimum(first, second) >= 0) & (np.maximum(first, second) < len(positions))
    with np.errstate(all="ignore"):
        apart = np.linalg.norm(positions[first[known]] - positions[second[known]], axis=1)
        ratio = np.linalg.norm(uvw[known], axis=1)[apart > 0] / apart[apart > 0]
        agrees = np.abs(ratio - 1) < TOLERANCE
    if np.count_nonzero(agrees) <= len(agrees) / 2:
        return None
    real = (np.abs(positions) < LONGEST_BASELINE).all(axis=1)
    placed = positions[real & positions.any(axis=1)]
    extent = max(float(np.linalg.norm(placed - place, axis=1).max()) for place in placed)
    dish = float(np.max(diameters, initial=0.0, where=diameters < LARGEST_DISH))
    return (1 + TOLERANCE) * extent + dish
