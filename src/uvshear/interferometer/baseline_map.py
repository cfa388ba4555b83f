"""The weights of an observation as a function of the length and the angle of its baselines."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.accumulate import Accumulator, accumulate
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float, Int

SHORTEST, LONGEST = 1.0, 1e8
"""Range of lengths that is divided into rings; shorter and longer baselines are in the first and last ring
[wavelengths]."""

PER_E_FOLD, PER_HALF_TURN = 40, 160
"""Number of rings in a factor of e in length, and of cells in half a turn: norms of galaxies with abs(e) <= 0.8 are
accurate to 1e-3."""

RINGS = math.ceil(math.log(LONGEST / SHORTEST) * PER_E_FOLD)


Factors = Callable[[Visibilities], Float[Array, "row chan"]]
"""Function that returns the factors T of another weighting for every sample of a chunk."""


@dataclass(frozen=True)
class BaselineMap:
    """Cells of baseline length and angle that hold weight; a baseline and its opposite share a cell.

    Parameters
    ----------
    weight
        Sum of the natural weights w [Jy^-2].
    weighted_sum
        Sum of w T, with T the factors of another weighting; the sum of w without another weighting.
    weighted_sum_of_squares
        Sum of w T^2; the sum of w without another weighting.
    u, v
        Mean baseline [wavelengths].
    log_frequency
        Mean of ln(frequency / Hz).
    ring
        Number of the ring of baseline lengths that the cell is in.
    """

    weight: Float[Array, " cell"]
    weighted_sum: Float[Array, " cell"]
    weighted_sum_of_squares: Float[Array, " cell"]
    u: Float[Array, " cell"]
    v: Float[Array, " cell"]
    log_frequency: Float[Array, " cell"]
    ring: Int[Array, " cell"]


class BaselineMapAccumulator(Accumulator[BaselineMap]):
    """Gathers a :class:`BaselineMap`.

    Parameters
    ----------
    factors
        Factors of another weighting, by which the weights of the visibilities are multiplied.
    """

    def __init__(self, factors: Factors | None = None) -> None:
        self._factors = factors
        self._sums = np.zeros((6, RINGS * PER_HALF_TURN))

    def add(self, seen: Visibilities) -> None:
        """Take in the next chunk."""
        factors = None if self._factors is None else self._factors(seen)
        for chan, frequency in enumerate(seen.frequency):
            factor = None if factors is None else factors[:, chan]
            _add(seen, chan, float(frequency), factor, self._sums)

    def merge(self, later: Self) -> None:
        """Add the sums over later visibilities."""
        self._sums += later._sums

    def result(self) -> BaselineMap:
        """Return the cells that hold weight."""
        (filled,) = np.nonzero(self._sums[0] > 0)
        weight, weighted_sum, weighted_sum_of_squares, *means = self._sums[:, filled]
        u, v, log_frequency = (mean / weight for mean in means)
        return BaselineMap(
            weight,
            weighted_sum,
            weighted_sum_of_squares,
            u,
            v,
            log_frequency,
            filled // PER_HALF_TURN,
        )


def map_baselines(
    observation: Observation, factors: Factors | None = None, executor: Executor = SERIAL
) -> BaselineMap:
    """Read an observation once and map its weights."""
    (cells,) = accumulate(observation, [BaselineMapAccumulator(factors)], executor)
    return cells


def rings_of(length: Float[Array, "..."]) -> Int[Array, "..."]:
    """Return the number of the ring that a baseline of this length [wavelengths] is in."""
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
    # A baseline and its opposite hold the same information: both are counted in the half plane v >= 0.
    flipped = np.where((v < 0) | ((v == 0) & (u < 0)), -1.0, 1.0)
    u, v = u * flipped, v * flipped
    angle = np.clip(np.arctan2(v, u) / math.pi * PER_HALF_TURN, 0, PER_HALF_TURN - 1)
    cell = rings_of(np.hypot(u, v)) * PER_HALF_TURN + angle.astype(int)
    weighted = weight if factor is None else weight * factor
    squared = weight if factor is None else weighted * factor
    values = (weight, weighted, squared, weight * u, weight * v, weight * math.log(frequency))
    for row, value in enumerate(values):
        sums[row] += np.bincount(cell, value, sums.shape[1])
