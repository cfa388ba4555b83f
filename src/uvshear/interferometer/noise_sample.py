"""A few thousand visibilities with their neighbours, from which the noise of an observation can be told."""

from dataclasses import dataclass, replace
from typing import Final, Self

import numpy as np

from uvshear.interferometer.accumulate import Accumulator
from uvshear.interferometer.reservoir import Columns, Reservoir
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Integrations, Visibilities
from uvshear.typing import Array, Bool, Float, Int

MOST: Final = 2**14
"""Number of visibilities that represent an observation: their noise is then known to 0.6 per cent. With their
neighbours they take 3 MB of memory."""

ENOUGH: Final = 2**22
"""Number of samples after which a pass that serves the noise alone ends."""

APART: Final = 1.5
"""Largest distance of successive integrations over the length of an integration. Across a longer gap, for example a
visit to a calibrator, the sky has turned."""


@dataclass(frozen=True)
class NoiseSample:
    """Visibilities drawn at random, and for each its neighbours in time and in frequency.

    Parameters
    ----------
    here
        The visibilities; all of them have weight.
    later
        The next integration of the same baseline and channel; its weight is 0 where there is none.
    beside
        A neighbouring channel of the same row; its weight is 0 where there is none.
    hand_powers
        Power of the difference of the two parallel hands over its variance (``stokes.powers_of_hands``), at other
        visibilities; empty where the hands are not known.
    """

    here: Samples
    later: Samples
    beside: Samples
    hand_powers: Float[Array, " drawn"]

    def within(self, uv_range: UvRange) -> "NoiseSample":
        """Return the visibilities on a range of baselines; the hands are those of all baselines."""
        distance = self.here.uv_distance
        chosen = (distance >= uv_range.minimum) & (distance <= uv_range.maximum * (1 + 1e-9))
        return self.select(chosen)

    def at_most(self, number: int) -> "NoiseSample":
        """Return this number of the visibilities, spread over all of them, or all if there are fewer."""
        if len(self.here) <= number:
            return self
        order = np.random.default_rng(0).permutation(len(self.here))
        return self.select(np.sort(order[:number]))

    def select(
        self, chosen: Bool[Array, " sample"] | Int[Array, " chosen"] | slice
    ) -> "NoiseSample":
        """Return some of the visibilities, with their neighbours."""
        return NoiseSample(
            self.here.select(chosen),
            self.later.select(chosen),
            self.beside.select(chosen),
            self.hand_powers,
        )


class NoiseSampleAccumulator(Accumulator[NoiseSample | None]):
    """Draws a :class:`NoiseSample` from an observation; None if no sample has weight.

    Neighbours are looked for in the same chunk.

    Parameters
    ----------
    most
        Largest number of visibilities in the sample.
    """

    def __init__(self, most: int = MOST) -> None:
        self._seen = 0
        self._triples, self._hands = Reservoir(most), Reservoir(most)

    @property
    def is_satisfied(self) -> bool:
        """Whether enough samples have been looked at for a pass to end that goes on for this accumulator alone."""
        return self._seen >= ENOUGH

    def add(self, seen: Visibilities) -> None:
        """Draw from the next chunk."""
        self._seen += seen.weights.size
        if seen.hand_powers is not None:
            places, numbers = self._hands.draw(len(seen.hand_powers))
            self._hands.add(numbers, (seen.hand_powers[places],))
        places, numbers = self._triples.draw(seen.weights.size)
        row, chan = np.unravel_index(places, seen.weights.shape)
        used = seen.weights[row, chan] > 0
        self._triples.add(numbers[used], _triples(seen, row[used], chan[used]))

    def merge(self, later: Self) -> None:
        """Take over what was drawn from later visibilities."""
        self._seen += later._seen
        self._triples.merge(later._triples)
        self._hands.merge(later._hands)

    def result(self) -> NoiseSample | None:
        """Return the sample."""
        columns, hands = self._triples.columns(), self._hands.columns()
        if not columns:
            return None
        each = len(columns) // 3
        here, later, beside = (Samples(*columns[k * each : (k + 1) * each]) for k in range(3))
        return NoiseSample(here, later, beside, hands[0] if hands else np.zeros(0))


def _triples(seen: Visibilities, row: Int[Array, " drawn"], chan: Int[Array, " drawn"]) -> Columns:
    """Return the columns of the samples at these places, of the next integrations, and of neighbouring channels."""
    # Averages over cells of (u, v, w) do not follow one another in time.
    later = _next_rows(seen.integrations if seen.averages is None else None, row)
    last = seen.weights.shape[1] - 1
    beside = np.where(chan < last, chan + 1, np.maximum(chan - 1, 0))
    groups = (
        (row, chan, np.ones(len(row), bool)),
        (np.maximum(later, 0), chan, later >= 0),
        (row, beside, beside != chan),
    )
    columns: list[Array] = []
    for rows, channels, exists in groups:
        samples = Samples.at(seen, rows, channels)
        samples = replace(samples, weights=np.where(exists, samples.weights, np.float32(0)))
        columns += [getattr(samples, name) for name in Samples.__dataclass_fields__]
    return tuple(columns)


def _next_rows(taken: Integrations | None, rows: Int[Array, " drawn"]) -> Int[Array, " drawn"]:
    """Return the row of the next integration of the same baseline, for each of some rows; -1 where there is none."""
    if taken is None or not len(rows):
        return np.full(len(rows), -1)
    first, second = taken.antennas.astype(np.int64).T
    baseline = first * (int(second.max()) + 1) + second
    candidates = np.flatnonzero(np.isin(baseline, np.unique(baseline[rows])))
    order = candidates[np.lexsort((taken.time[candidates], baseline[candidates]))]
    before, after = order[:-1], order[1:]
    apart = taken.time[after] - taken.time[before]
    is_next = (baseline[before] == baseline[after]) & (apart > 0)
    usual = float(np.median(apart[is_next])) if is_next.any() else 0.0
    is_next &= apart < APART * np.maximum(taken.interval[before], usual)
    following = np.full(len(baseline), -1)
    following[before[is_next]] = after[is_next]
    return following[rows]
