"""Observations whose visibilities stay in memory once they have been read."""

from collections.abc import Iterator

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Observation, Visibilities

BYTES_PER_SAMPLE = 80
"""Memory for each sample of an observation with a single channel; with more channels it is less."""


class HeldObservation:
    """An observation that is read once, and then stays in memory without the samples that cannot be right.

    Parameters
    ----------
    observation
        The observation.
    """

    def __init__(self, observation: Observation) -> None:
        self._observation = observation
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
        read = []
        for chunk in screened_chunks(self._observation):
            read.append(chunk)
            yield chunk
        self._held = tuple(read)


def held_within(observation: Observation, samples: int, memory: float) -> Observation:
    """Return an observation that stays in memory, or the observation itself where this memory is too small for it.

    Parameters
    ----------
    observation
        The observation.
    samples
        Its number of samples.
    memory
        Memory that it may take [bytes].
    """
    return HeldObservation(observation) if samples * BYTES_PER_SAMPLE <= memory else observation
