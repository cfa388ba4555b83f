"""Summary of an observation from one pass, before anything is measured."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.errors import InputError
from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.accumulate import Accumulator, accumulate
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float

PROBES = 4096
"""Number of samples that represent all of them where sources are attenuated differently."""


@dataclass(frozen=True)
class ObservationSummary:
    """Size of an observation, its longest baseline, its band and its weight.

    Parameters
    ----------
    rows
        Number of rows.
    samples
        Number of samples with a positive weight.
    longest
        Length of the longest baseline with a positive weight [wavelengths].
    frequency
        Highest frequency of a sample with weight [Hz].
    lowest_frequency
        Lowest frequency of a sample with weight [Hz].
    weight
        Sum of the weights [Jy^-2]: 1/weight is the variance of a point source's flux.
    probes
        A few thousand of the samples, drawn at random.
    """

    rows: int
    samples: int
    longest: float
    frequency: float
    lowest_frequency: float
    weight: float
    probes: Samples


class SummaryAccumulator(Accumulator[ObservationSummary]):
    """Gathers an :class:`ObservationSummary`.

    Every sample with weight is given a random number, and the samples with the lowest numbers are the probes. This is a
    uniform draw although the number of samples is not known beforehand.

    Parameters
    ----------
    part
        Number of the part, where a pass is divided: each part has random numbers of its own.
    """

    def __init__(self, part: int = 0) -> None:
        seed = np.random.SeedSequence(0, spawn_key=(part,) if part else ())
        self._generator = np.random.default_rng(seed)
        self._rows = self._samples = 0
        self._longest = self._weight = self._highest = 0.0
        self._lowest = float("inf")
        self._probes: Samples | None = None
        self._numbers: Float[Array, " probe"] = np.zeros(0)

    def add(self, seen: Visibilities) -> None:
        """Take in the next chunk."""
        used = seen.weights > 0
        self._rows += len(seen)
        self._weight += float(seen.weights.sum(dtype=float))
        if not used.any():
            return
        frequency = seen.frequency[used.any(axis=0)]
        self._highest = max(self._highest, float(frequency.max()))
        self._lowest = min(self._lowest, float(frequency.min()))
        self._longest = max(self._longest, float(seen.uv_distance[used].max()))
        row, chan = np.nonzero(used)
        self._samples += len(row)
        numbers = self._generator.random(len(row))
        if len(self._numbers) == PROBES:
            (candidates,) = np.nonzero(numbers < self._numbers.max())
        else:
            candidates = np.arange(len(numbers))
        drawn = candidates[np.argsort(numbers[candidates])[:PROBES]]
        if len(drawn):
            self._draw(Samples.at(seen, row[drawn], chan[drawn]), numbers[drawn])

    def merge(self, later: Self) -> None:
        """Add the sums over later visibilities."""
        self._rows += later._rows
        self._samples += later._samples
        self._highest = max(self._highest, later._highest)
        self._lowest = min(self._lowest, later._lowest)
        self._weight += later._weight
        self._longest = max(self._longest, later._longest)
        if later._probes is not None:
            self._draw(later._probes, later._numbers)

    def result(self) -> ObservationSummary:
        """Return the summary.

        Raises
        ------
        InputError
            No sample carries weight.
        """
        if self._probes is None:
            raise InputError(
                "no visibility carries weight: all are flagged, have no positive weight, or have impossible values"
                " (uvshear info shows how many, and why)"
            )
        return ObservationSummary(
            self._rows,
            self._samples,
            self._longest,
            self._highest,
            self._lowest,
            self._weight,
            self._probes,
        )

    def _draw(self, samples: Samples, numbers: Float[Array, " probe"]) -> None:
        """Keep the samples with the lowest numbers of those that were kept and these."""
        joined = samples if self._probes is None else Samples.join([self._probes, samples])
        joined_numbers = np.append(self._numbers, numbers)
        lowest = np.sort(np.argsort(joined_numbers)[:PROBES])
        self._probes, self._numbers = joined.select(lowest), joined_numbers[lowest]


def summarise(observation: Observation, executor: Executor = SERIAL) -> ObservationSummary:
    """Read an observation once for its summary."""
    (summary,) = accumulate(observation, [SummaryAccumulator()], executor)
    return summary
