"""Baselines and the distances of the antennas of a Measurement Set."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from casacore import tables

from uvshear.interferometer.layout import EARTH_RADIUS_RANGE
from uvshear.interferometer.primary_beam import LARGEST_DISH
from uvshear.interferometer.screening import LONGEST_BASELINE
from uvshear.io.measurement_set.antennas import read_antennas
from uvshear.typing import Array, Float

ROWS_COMPARED: Final = 256
"""Number of rows, spread over the set, whose UVW is compared with the antennas' positions."""

TOLERANCE: Final = 0.01
"""Relative difference between the length of UVW and the distance of two antennas that is taken as agreement. Geodesy,
aberration and averaging make less than 1e-3."""


@dataclass(frozen=True)
class ArraySize:
    """The array by the positions of its antennas.

    Parameters
    ----------
    longest_baseline
        Length that no baseline exceeds [m]: that of the array, and one per cent, and one dish. None unless most of the
        compared rows have a UVW as long as the distance of their antennas.
    wrong_ratio
        Median of the lengths of UVW over these distances, if the antennas stand on the Earth and most rows disagree
        with them; None otherwise. Positions that are missing or refer to another frame tell nothing.
    """

    longest_baseline: float | None = None
    wrong_ratio: float | None = None


def array_size(path: Path, main: tables.table) -> ArraySize:
    """Compare UVW with the positions of the antennas, in some rows."""
    positions, diameters = read_antennas(path)
    if len(positions) < 2:
        return ArraySize()
    ratio = _length_over_distance(main, positions)
    agrees = np.abs(ratio - 1) < TOLERANCE
    if np.count_nonzero(agrees) <= len(agrees) / 2:
        is_told = len(ratio) > 0 and _stand_on_earth(positions)
        return ArraySize(wrong_ratio=float(np.median(ratio)) if is_told else None)
    real = (np.abs(positions) < LONGEST_BASELINE).all(axis=1)
    placed = positions[real & positions.any(axis=1)]
    extent = max(float(np.linalg.norm(placed - place, axis=1).max()) for place in placed)
    dish = float(np.max(diameters, initial=0.0, where=diameters < LARGEST_DISH))
    return ArraySize(longest_baseline=(1 + TOLERANCE) * extent + dish)


def _length_over_distance(
    main: tables.table, positions: Float[Array, "antenna 3"]
) -> Float[Array, " row"]:
    """Return the length of UVW over the distance of the antennas, for rows of two antennas whose distance is known."""
    rows = np.unique(np.linspace(0, main.nrows() - 1, ROWS_COMPARED).astype(int))
    chosen = main.selectrows(rows)
    first, second = (np.asarray(chosen.getcol(name), int) for name in ("ANTENNA1", "ANTENNA2"))
    uvw = np.asarray(chosen.getcol("UVW"), float)
    known = (np.minimum(first, second) >= 0) & (np.maximum(first, second) < len(positions))
    with np.errstate(all="ignore"):
        apart = np.linalg.norm(positions[first[known]] - positions[second[known]], axis=1)
        ratio: Float[Array, " row"] = (
            np.linalg.norm(uvw[known], axis=1)[apart > 0] / apart[apart > 0]
        )
    return ratio[np.isfinite(ratio)]


def _stand_on_earth(positions: Float[Array, "antenna 3"]) -> bool:
    with np.errstate(all="ignore"):
        radius = np.linalg.norm(positions, axis=1)
    low, high = EARTH_RADIUS_RANGE
    return bool(np.all((radius > low) & (radius < high)))
