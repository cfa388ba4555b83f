"""An observation whose visibilities stay in memory after the first complete pass, if they fit."""

from collections.abc import Iterator

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.screening import screened_chunks
from uvshear.interferometer.visibilities import Observation, Visibilities

HELD_PART = 1 / 8
"""Part of the memory of a measurement that the visibilities may take between passes."""


class HeldObservation:
    """An observation whose visibilities stay in memory after the first complete pass, if they fit.

    Impossible samples have a weight of zero (``screening``). The same chunks are yielded in every pass, so that callers
    must not modify them.

    Parameters
    ----------
    observation
        The observation.
    memory
        Memory that the visibilities may occupy [bytes]. A larger observation is read again in every pass.
    """

    def __init__(self, observation: Observation, memory: float) -> None:
        self._observation, self._memory = observation, memory
        self._held: tuple[Visibilities, ...] | None = None

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self._observation.phase_centre

    def origin(self) -> Origin:
        """Return the origin of the observation that is held."""
        return origin_of(self._observation)

    def release(self) -> None:
        """Release the visibilities; the next pass reads them again."""
        self._held = None

    def chunks(self) -> Iterator[Visibilities]:
        """Yield the chunks from memory if they are held; otherwise read them, and hold them if all of them fit."""
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


def held_by_parts(observation: Observation, memory: float) -> Observation:
    """Return an observation each of whose parts stays in memory if it fits into its share; all shares are equal."""
    parts = parts_of(observation)
    held = tuple(HeldObservation(part, memory / len(parts)) for part in parts)
    return held[0] if len(held) == 1 else JointObservation(observation.phase_centre, held)


def release(observation: Observation) -> None:
    """Release the visibilities of the parts that stay in memory; another pass reads them again."""
    for part in parts_of(observation):
        if isinstance(part, HeldObservation):
            part.release()


def _bytes_of(chunk: Visibilities) -> int:
    arrays = [chunk.uvw, chunk.stokes_i, chunk.weights]
    if (seen := chunk.integrations) is not None:
        arrays += [seen.antennas, seen.time, seen.interval]
    return sum(array.nbytes for array in arrays)
