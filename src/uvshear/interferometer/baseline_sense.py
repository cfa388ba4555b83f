"""Comparison of stored baselines with the antennas' positions: whether UVW is X(ANTENNA1) - X(ANTENNA2)."""

from typing import Final

import numpy as np

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.array_extent import LONGEST_BASELINE
from uvshear.interferometer.coverage import antenna_uvw, sidereal_time
from uvshear.interferometer.visibilities import Integrations
from uvshear.typing import Array, Bool, Float

CLEAR: Final = 0.9
"""Cosine of the angle between stored and computed baselines above which the sign is certain."""


def sense_agrees(
    stored: Float[Array, "row 3"],
    integrations: Integrations,
    positions: Float[Array, "antenna 3"],
    phase_centre: PhaseCentre,
) -> bool | None:
    """Whether UVW as stored is X(ANTENNA1) - X(ANTENNA2); False for the opposite, None if neither fits.

    Parameters
    ----------
    stored
        Baselines of the compared rows [m].
    integrations
        Antennas and times of these rows; times are Modified Julian Dates in UTC [s].
    positions
        Geocentric positions of all antennas [m]; NaN where they are not known.
    phase_centre
        Direction of l = m = 0.

    Notes
    -----
    Precession is neglected: 0.4 degrees in 30 years do not matter for a comparison of signs.
    """
    known = _comparable(stored, integrations, positions)
    if not known.any():
        return None
    compared = integrations.select(known)
    hour_angle = sidereal_time(compared.time) - phase_centre.ra
    computed = np.array(
        [
            antenna_uvw(positions[pair], hour_angle[[row]], phase_centre.dec)[0]
            for row, pair in enumerate(compared.antennas)
        ]
    )
    return _sense(stored[known], computed[:, 0] - computed[:, 1])


def _comparable(
    stored: Float[Array, "row 3"],
    integrations: Integrations,
    positions: Float[Array, "antenna 3"],
) -> Bool[Array, " row"]:
    """Tell which rows have a UVW, a time, and two antennas of known positions."""
    antennas, time = integrations.antennas, integrations.time
    known = (antennas >= 0).all(axis=1) & (antennas < len(positions)).all(axis=1)
    known &= antennas[:, 0] != antennas[:, 1]
    known &= (np.abs(stored) < LONGEST_BASELINE).all(axis=1) & np.isfinite(time)
    if not known.any():
        return known
    ends = positions[np.where(known[:, None], antennas, 0)]
    return known & (np.abs(ends) < LONGEST_BASELINE).all(axis=(1, 2))


def _sense(stored: Float[Array, "row 3"], computed: Float[Array, "row 3"]) -> bool | None:
    lengths = np.linalg.norm(stored, axis=1) * np.linalg.norm(computed, axis=1)
    if not np.any(lengths > 0):
        return None
    projections = np.sum(stored * computed, axis=1)[lengths > 0]
    cosine = float(np.median(projections / lengths[lengths > 0]))
    if abs(cosine) < CLEAR:
        return None
    return cosine > 0
