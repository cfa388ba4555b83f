"""The weights of an observation over the length and the angle of its baselines."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.visibilities import Visibilities
from uvshear.typing import Array, Float, Int

SHORTEST, LONGEST = 1.0, 1e8
"""Lengths between which baselines are told apart [wavelengths]."""

PER_E_FOLD, PER_HALF_TURN = 40, 160
"""Cells along the logarithm of the length, and along the angle: norms of galaxies with \\|e\\| <= 0.8 are good to
1e-3."""

RINGS = math.ceil(math.log(LONGEST / SHORTEST) * PER_E_FOLD)


@dataclass(frozen=True)
class BaselineMap:
    """Cells that hold a weight; of a baseline and its opposite one is counted.

    Parameters
    ----------
    weight
        Sums of the weights w [Jy^-2].
    once, twice
        Sums of w T and w T^2, with T the factors of another weighting; those of w where there is none.
    u, v
        Mean baseline [wavelengths].
    log_frequency
        Mean of ln(frequency / Hz).
    ring
        Number of the cell's length.
    """

    weight: Float[Array, " cell"]
    once: Float[Array, " cell"]
    twice: Float[Array, " cell"]
    u: Float[Array, " cell"]
    v: Float[Array, " cell"]
    log_frequency: Float[Array, " cell"]
    ring: Int[Array, " cell"]

    @classmethod
    def of(
        cls, chunks: Iterable[tuple[Visibilities, Float[Array, "row chan"] | None]]
    ) -> "BaselineMap":
        """Read chunks, each with the factors T of its weights."""
        sums = np.zeros((6, RINGS * PER_HALF_TURN))
        for seen, factors in chunks:
            for chan, frequency in enumerate(seen.frequency):
                factor = None if factors is None else factors[:, chan]
                _add(seen, chan, float(frequency), factor, sums)
        ring = np.flatnonzero(sums[0] > 0) // PER_HALF_TURN
        weight, once, twice, *means = sums[:, sums[0] > 0]
        u, v, log_frequency = (mean / weight for mean in means)
        return cls(weight, once, twice, u, v, log_frequency, ring)


def rings_of(length: Float[Array, "..."]) -> Int[Array, "..."]:
    """Return the number of a baseline's ring, by its length [wavelengths]."""
    return (np.log(np.clip(length, SHORTEST, LONGEST * 0.999) / SHORTEST) * PER_E_FOLD).astype(int)


def _add(
    seen: Visibilities,
    chan: int,
    frequency: float,
    factor: Float[Array, " row"] | None,
    sums: Float[Array, "6 cell"],
) -> None:
    weight = seen.weights[:, chan].astype(float)
    u, v = seen.uvw[:, :2].T * (frequency / SPEED_OF_LIGHT)
    # Of the pair u and -u one is enough.
    flipped = np.where((v < 0) | ((v == 0) & (u < 0)), -1.0, 1.0)
    u, v = u * flipped, v * flipped
    angle = np.clip(np.arctan2(v, u) / math.pi * PER_HALF_TURN, 0, PER_HALF_TURN - 1)
    cell = rings_of(np.hypot(u, v)) * PER_HALF_TURN + angle.astype(int)
    once = weight if factor is None else weight * factor
    twice = weight if factor is None else once * factor
    values = (weight, once, twice, weight * u, weight * v, weight * math.log(frequency))
    for row, value in enumerate(values):
        sums[row] += np.bincount(cell, value, sums.shape[1])
