"""Totals of the counts that a reader attaches to its chunks."""

from typing import Self

from uvshear.interferometer.accumulate import Accumulator
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.visibilities import Visibilities


class SampleCountsAccumulator(Accumulator[SampleCounts | None]):
    """Adds up the counts of all chunks; the result is None where no chunk has any."""

    def __init__(self) -> None:
        self._total: SampleCounts | None = None

    def add(self, seen: Visibilities) -> None:
        """Add the counts of the next chunk."""
        self._add(seen.counts)

    def merge(self, later: Self) -> None:
        """Add the counts of later chunks."""
        self._add(later._total)

    def result(self) -> SampleCounts | None:
        """Return the totals."""
        return self._total

    def _add(self, counts: SampleCounts | None) -> None:
        if counts is not None:
            self._total = counts if self._total is None else self._total + counts
