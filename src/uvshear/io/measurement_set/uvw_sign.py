"""Comparison of the baselines in a Measurement Set with its antennas' positions; nothing is changed."""

from pathlib import Path
from typing import Final

import numpy as np

from uvshear.interferometer.coverage import antenna_uvw, sidereal_time
from uvshear.interferometer.screening import LONGEST_BASELINE
from uvshear.io.measurement_set.antennas import read_antennas
from uvshear.io.measurement_set.header import Header
from uvshear.io.measurement_set.opening import casacore_errors, open_table
from uvshear.typing import Array, Bool, Float, Int

ROWS_COMPARED: Final = 256
"""Number of rows, spread over the set, that are compared."""

CLEAR: Final = 0.9
"""Cosine of the angle between stored and computed baselines above which the sign is certain."""


def uvw_sign_agrees(path: Path, header: Header) -> bool | None:
    """Whether UVW as stored is X(ANTENNA1) - X(ANTENNA2); False for the opposite, None if neither fits.

    Notes
    -----
    Precession is neglected: 0.4 degrees in 30 years do not matter for a comparison of signs.
    """
    with open_table(path) as main, casacore_errors(path, "UVW"):
        rows = np.unique(np.linspace(0, header.rows - 1, ROWS_COMPARED).astype(int))
        chosen = main.selectrows(rows)
        stored = np.asarray(chosen.getcol("UVW"), dtype=float)
        first, second = chosen.getcol("ANTENNA1"), chosen.getcol("ANTENNA2")
        time = np.asarray(chosen.getcol("TIME"), dtype=float)
        same_field = (
            np.ones(len(rows), dtype=bool)
            if header.is_only_field
            else np.isin(chosen.getcol("FIELD_ID"), header.field.numbers)
        )
    positions, _ = read_antennas(path)
    known = _comparable(stored, time, np.stack([first, second]), positions) & same_field
    if not known.any():
        return None
    first, second = first[known], second[known]
    hour_angle = sidereal_time(time[known]) - header.phase_centre.ra
    computed = np.array(
        [
            antenna_uvw(positions[[p, q]], hour_angle[[row]], header.phase_centre.dec)[0]
            for row, (p, q) in enumerate(zip(first, second, strict=True))
        ]
    )
    return _sense(stored[known], computed[:, 0] - computed[:, 1])


def _comparable(
    stored: Float[Array, "row 3"],
    time: Float[Array, " row"],
    antennas: Int[Array, "2 row"],
    positions: Float[Array, "antenna 3"],
) -> Bool[Array, " row"]:
    """Tell which rows have a UVW, a time, and two antennas of known positions."""
    known = (antennas >= 0).all(axis=0) & (antennas < len(positions)).all(axis=0)
    known &= antennas[0] != antennas[1]
    known &= (np.abs(stored) < LONGEST_BASELINE).all(axis=1) & np.isfinite(time)
    ends = positions[np.where(known, antennas, 0)] if known.any() else np.zeros((2, len(time), 3))
    return known & (np.abs(ends) < LONGEST_BASELINE).all(axis=(0, 2))


def _sense(stored: Float[Array, "row 3"], computed: Float[Array, "row 3"]) -> bool | None:
    lengths = np.linalg.norm(stored, axis=1) * np.linalg.norm(computed, axis=1)
    if not np.any(lengths > 0):
        return None
    projections = np.sum(stored * computed, axis=1)[lengths > 0]
    cosine = float(np.median(projections / lengths[lengths > 0]))
    if abs(cosine) < CLEAR:
        return None
    return cosine > 0
