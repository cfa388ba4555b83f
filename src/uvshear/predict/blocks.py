"""Passes over visibilities that work on a block of samples at a time, however the chunks are read."""

from abc import abstractmethod
from typing import Self

from uvshear.execution import give_back_free_memory
from uvshear.interferometer.accumulate import Accumulator, Result_co
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Visibilities
from uvshear.predict.gridded import Gridding

_AT_A_TIME = 2**16
"""Number of visibilities that a worker selects from at a time."""


class BlockAccumulator(Accumulator[Result_co]):
    """Collects the samples of a range of baselines, and processes them whenever a block is full.

    Blocks have the same samples whatever the chunks, so that sums do not depend on how an observation is read.

    Parameters
    ----------
    shortest, longest
        Range of the baselines [wavelengths].
    gridding
        Number of samples in a block, and the executor that selects them.
    """

    def __init__(self, shortest: float, longest: float, gridding: Gridding) -> None:
        self._shortest, self._longest = shortest, longest
        self._size, self._executor = gridding.block, gridding.executor
        self._waiting: list[Samples] = []
        self._held = 0

    def add(self, seen: Visibilities) -> None:
        """Take in the samples of a chunk."""
        rows = max(1, _AT_A_TIME // max(1, len(seen.frequency)))

        def select(first: int) -> Samples:
            part = seen.of_rows(slice(first, first + rows))
            return Samples.from_visibilities(part, self._shortest, self._longest)

        for part in self._executor.map(select, range(0, len(seen), rows)):
            self._take(part)

    def merge(self, later: Self) -> None:
        """Add the sums of another accumulator, and take over the samples that it has not processed."""
        self.add_sums(later)
        for part in later._waiting:
            self._take(part)

    def result(self) -> Result_co:
        """Process the remaining samples, and return the sums."""
        if self._waiting:
            self._work_on_waiting()
        return self.total()

    @abstractmethod
    def add_block(self, samples: Samples) -> None:
        """Process a block of samples, which nobody else holds."""

    @abstractmethod
    def add_sums(self, later: Self) -> None:
        """Add the sums of another accumulator of this kind."""

    @abstractmethod
    def total(self) -> Result_co:
        """Return the sums over all blocks."""

    def _take(self, part: Samples) -> None:
        while self._held + len(part) >= self._size:
            first = self._size - self._held
            self._waiting.append(part.select(slice(first)))
            self._work_on_waiting()
            part = part.select(slice(first, None))
        if len(part):
            self._waiting.append(part)
            self._held += len(part)

    def _work_on_waiting(self) -> None:
        self.add_block(self._joined())
        give_back_free_memory()

    def _joined(self) -> Samples:
        """Return the waiting samples, and hold them no longer."""
        block = Samples.join(self._waiting)
        self._waiting, self._held = [], 0
        give_back_free_memory()
        return block
