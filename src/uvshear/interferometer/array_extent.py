"""The longest baseline that an array can have, by the positions of its antennas."""

from typing import Final

import numpy as np

from uvshear.interferometer.primary_beam import LARGEST_DISH
from uvshear.interferometer.screening import LONGEST_BASELINE
from uvshear.typing import Array, Float, Int

ROWS_COMPARED: Final = 256
"""Number of rows, spread over the data, whose UVW is compared with the antennas' positions."""

TOLERANCE: Final = 0.01
"""Relative difference between the length of UVW and the distance of two antennas that is taken as agreement. Geodesy,
aberration and averaging make less than 1e-3."""


def array_extent(
    positions: Float[Array, "antenna 3"],
    diameters: Float[Array, " antenna"],
    antennas: Int[Array, "row 2"],
    uvw: Float[Array, "row 3"],
) -> float | None:
    """Return a length that no baseline exceeds [m]: that of the array, and one per cent, and one dish.

    The result is None unless most of the compared rows have a UVW as long as the distance of their antennas: positions
    may be missing, or refer to another frame.

    Parameters
    ----------
    positions
        Geocentric positions [m]; NaN or 0 where they are not known.
    diameters
        Diameters of the dishes [m]; 0 where they are not known.
    antennas
        Numbers of ANTENNA1 and ANTENNA2 of the compared rows.
    uvw
        Baselines of the compared rows [m].
    """
    if len(positions) < 2:
        return None
    first, second = antennas[:, 0], antennas[:, 1]
    known = (antennas.min(axis=1) >= 0) & (antennas.max(axis=1) < len(positions))
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
