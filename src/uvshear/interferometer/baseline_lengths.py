"""Comparison of UVW with the distances between the antennas, from which the extent of the array follows."""

from typing import Final

import numpy as np

from uvshear.interferometer.array_extent import LONGEST_BASELINE, TOLERANCE, ArrayExtent
from uvshear.interferometer.layout import EARTH_RADIUS_RANGE
from uvshear.interferometer.primary_beam import LARGEST_DISH
from uvshear.typing import Array, Float, Int

ROWS_COMPARED: Final = 256
"""Number of rows, spread over the data, whose UVW is compared with the antennas' positions."""

UNKNOWN_DISH: Final = 25.0
"""Margin of the length of a baseline if no diameter of a dish is known [m]."""


def array_extent(
    positions: Float[Array, "antenna 3"],
    diameters: Float[Array, " antenna"],
    antennas: Int[Array, "row 2"],
    uvw: Float[Array, "row 3"],
) -> ArrayExtent:
    """Compare UVW with the positions of the antennas, in some rows.

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
        return ArrayExtent()
    ratio = _length_over_distance(positions, antennas, uvw)
    agrees = np.abs(ratio - 1) < TOLERANCE
    if np.count_nonzero(agrees) <= len(agrees) / 2:
        is_told = len(ratio) > 0 and _stand_on_earth(positions)
        return ArrayExtent(wrong_ratio=float(np.median(ratio)) if is_told else None)
    real = (np.abs(positions) < LONGEST_BASELINE).all(axis=1)
    placed = positions[real & positions.any(axis=1)]
    extent = max(float(np.linalg.norm(placed - place, axis=1).max()) for place in placed)
    dish = float(np.max(diameters, initial=0.0, where=diameters < LARGEST_DISH))
    return ArrayExtent(
        longest_baseline=(1 + TOLERANCE) * extent + dish,
        positions=np.where((real & positions.any(axis=1))[:, None], positions, np.nan),
        margin=dish or UNKNOWN_DISH,
    )


def _length_over_distance(
    positions: Float[Array, "antenna 3"], antennas: Int[Array, "row 2"], uvw: Float[Array, "row 3"]
) -> Float[Array, " known"]:
    """Return the length of UVW over the distance of the antennas, for rows of two antennas whose distance is known."""
    first, second = antennas[:, 0], antennas[:, 1]
    known = (antennas.min(axis=1) >= 0) & (antennas.max(axis=1) < len(positions))
    with np.errstate(all="ignore"):
        apart = np.linalg.norm(positions[first[known]] - positions[second[known]], axis=1)
        ratio = np.linalg.norm(uvw[known], axis=1)[apart > 0] / apart[apart > 0]
    return ratio[np.isfinite(ratio)]


def _stand_on_earth(positions: Float[Array, "antenna 3"]) -> bool:
    with np.errstate(all="ignore"):
        radius = np.linalg.norm(positions, axis=1)
    low, high = EARTH_RADIUS_RANGE
    return bool(np.all((radius > low) & (radius < high)))
