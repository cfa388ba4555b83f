"""UVW and the distances between antennas: whether they agree, and the longest baseline that an array can have."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from uvshear.interferometer.layout import EARTH_RADIUS_RANGE
from uvshear.interferometer.primary_beam import LARGEST_DISH
from uvshear.interferometer.screening import LONGEST_BASELINE
from uvshear.typing import Array, Float, Int

ROWS_COMPARED: Final = 256
"""Number of rows, spread over the data, whose UVW is compared with the antennas' positions."""

TOLERANCE: Final = 0.01
"""Relative difference between the length of UVW and the distance of two antennas that is taken as agreement. Geodesy,
aberration and averaging cause less than 1e-3."""


@dataclass(frozen=True)
class ArrayExtent:
    """The extent of an array by the positions of its antennas.

    Parameters
    ----------
    longest_baseline
        Length that no baseline exceeds [m]: the largest distance between two antennas, plus one per cent, plus the
        diameter of a dish. None unless UVW is as long as the distance between the antennas in most compared rows.
    wrong_ratio
        Median ratio of the length of UVW to these distances, if the antennas stand on the Earth and most rows disagree
        with them; None otherwise. Positions that are missing or in another frame cannot be compared with UVW.
    """

    longest_baseline: float | None = None
    wrong_ratio: float | None = None

    @property
    def notice(self) -> str | None:
        """What a user should know about a UVW that does not fit the antennas; None if it fits."""
        if self.wrong_ratio is None:
            return None
        return (
            f"UVW and the positions of the antennas disagree: the length of UVW is {self.wrong_ratio:.3g} times the"
            " distance of the antennas (median)"
        )


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
    return ArrayExtent(longest_baseline=(1 + TOLERANCE) * extent + dish)


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
