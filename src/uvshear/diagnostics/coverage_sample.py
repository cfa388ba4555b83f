"""Baselines of an observation for a picture of its uv coverage."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.interferometer.accumulate import Accumulator, accumulate
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class CoverageSample:
    """Baselines of an observation: all of them, or a random sample.

    Parameters
    ----------
    uvw
        Baselines [m].
    frequency
        Channel centres [Hz].
    rows
        Number of rows with weight in the observation.
    """

    uvw: Float[Array, "row 3"]
    frequency: Float[Array, " chan"]
    rows: int


class CoverageAccumulator(Accumulator[CoverageSample]):
    """Draws baselines that carry weight: a random sample where there are more than ``most``."""

    def __init__(self, most: int = 1_000_000) -> None:
        self._most = most
        self._uvw, self._lots = np.empty((0, 3)), np.empty(0)
        self._frequencies: set[float] = set()
        self._rows, self._part = 0, 1.0
        # A regular stride would select the same baselines again and again.
        self._rng = np.random.default_rng(0)

    def add(self, seen: Visibilities) -> None:
        """Draw a random number for each row, and keep the rows below a limit that falls with the number of rows."""
        uvw = seen.uvw[np.any(seen.weights > 0, axis=1)]
        self._frequencies.update(seen.frequency.tolist())
        self._rows += len(uvw)
        self._join(uvw, self._rng.uniform(size=len(uvw)))

    def merge(self, later: Self) -> None:
        """Add the baselines that were drawn from later visibilities."""
        self._frequencies |= later._frequencies
        self._rows += later._rows
        self._part = min(self._part, later._part)
        self._join(later._uvw, later._lots)
        self._keep_below(self._part)

    def result(self) -> CoverageSample:
        """Return the baselines that were drawn."""
        return CoverageSample(self._uvw, np.array(sorted(self._frequencies)), self._rows)

    def _join(self, uvw: Float[Array, "row 3"], lots: Float[Array, " row"]) -> None:
        self._uvw = np.concatenate([self._uvw, uvw])
        self._lots = np.concatenate([self._lots, lots])
        if len(self._uvw) > self._most:
            self._keep_below(self._most / self._rows)

    def _keep_below(self, part: float) -> None:
        self._part = min(self._part, part)
        kept = self._lots < self._part
        self._uvw, self._lots = self._uvw[kept], self._lots[kept]


def sample_coverage(observation: Observation, most: int = 1_000_000) -> CoverageSample:
    """Read an observation once, and draw about ``most`` of its baselines, or all of them if there are fewer."""
    (sample,) = accumulate(observation, [CoverageAccumulator(most)])
    return sample
