"""Observations whose visibilities stay in memory once they have been read."""

from collections.abc import Iterator

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Observation, Visibilities


class HeldObservation:
    """An observation that is read once, and then stays in memory if it fits into a part of it.

    Samples that cannot be right have a weight of zero. A chunk is not changed by those who have read it.

    Parameters
    ----------
    observation
        The observation.
    memory
        Memory that it may take [bytes]; an observation that takes more is read again each time.
    """

    def __init__(self, observation: Observation, memory: float) -> None:
        self._observation, self._memory = observation, memory
        self._held: tuple[Visibilities, ...] | None = None

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self._observation.phase_centre

    def chunks(self) -> Iterator[Visibilities]:
        """Read everything, if it has not been read to its end before."""
        if self._held is not None:
            yield from self._held
            return
        read: list[Visibilities] = []
        taken = 0
        for chunk in screened_chunks(self._observation):
            taken += _bytes_of(chunk)
            if taken <= self._memory:
                read.append(chunk)
            else:
                read.clear()
            yield chunk
        if taken <= self._memory:
            self._held = tuple(read)


def _bytes_of(chunk: Visibilities) -> int:
    arrays = [chunk.uvw, chunk.stokes_i, chunk.weights]
    if (seen := chunk.integrations) is not None:
        arrays += [seen.antennas, seen.time, seen.interval]
    return sum(array.nbytes for array in arrays)
