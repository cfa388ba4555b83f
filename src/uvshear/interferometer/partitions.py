"""Partitions of an observation: ranges of rows, each of which a worker reads from the file by itself."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.origin import Origin, origin_of
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.visibilities import Observation, Visibilities


@runtime_checkable
class HasRows(Observation, Protocol):
    """An observation in a file whose rows can be read from any one on; it can be pickled without its visibilities."""

    @property
    def rows(self) -> int:
        """Number of rows."""
        ...

    @property
    def samples_per_row(self) -> int:
        """Largest number of samples of a row."""
        ...

    @property
    def rows_per_chunk(self) -> int:
        """Number of rows of a chunk."""
        ...

    def check_usable(self, counts: SampleCounts) -> None:
        """Refuse an observation of which no visibility can be used, given the numbers of all of its samples."""
        ...

    def rows_between(self, first: int, stop: int) -> Iterator[Visibilities]:
        """Read the rows from ``first``, which begins a chunk, up to ``stop``."""
        ...


@dataclass(frozen=True)
class RowRange:
    """The rows of an observation from ``first`` up to ``stop``, as an observation."""

    whole: HasRows
    first: int
    stop: int

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.whole.phase_centre

    @property
    def samples(self) -> int:
        """Number of samples, with or without weight."""
        return (self.stop - self.first) * self.whole.samples_per_row

    def origin(self) -> Origin:
        """Return the origin of the whole observation."""
        return origin_of(self.whole)

    def chunks(self) -> Iterator[Visibilities]:
        """Read the rows once: those of the whole observation if they are all."""
        if (self.first, self.stop) == (0, self.whole.rows):
            return self.whole.chunks()
        return self.whole.rows_between(self.first, self.stop)


def partitions_of(observation: HasRows, samples: int) -> Sequence[RowRange]:
    """Divide an observation into ranges of whole chunks, as equal as can be, with at most about this many samples."""
    chunk = observation.rows_per_chunk
    count = max(1, math.ceil(observation.rows * observation.samples_per_row / samples))
    rows = max(1, math.ceil(observation.rows / (count * chunk))) * chunk
    firsts = range(0, max(1, observation.rows), rows)
    return [RowRange(observation, k, min(k + rows, observation.rows)) for k in firsts]
