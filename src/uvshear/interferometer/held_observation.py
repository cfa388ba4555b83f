"""An observation whose visibilities stay in memory after the first complete pass, if they fit."""

from collections.abc import Iterator, Sequence

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.origin import Origin, origin_of, parts_of
from uvshear.interferometer.partitions import HasRows, partitions_of
from uvshear.interferometer.sample_counts import SampleCounts
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

    def __getstate__(self) -> dict[str, object]:
        """Leave out the visibilities; another process reads them itself."""
        return {**self.__dict__, "_held": None}

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


class HeldPartitions:
    """An observation in a file, of which each range of rows stays in memory after it was read if it fits.

    Parameters
    ----------
    observation
        The observation.
    samples
        Largest number of samples of a range.
    memory
        Memory that all visibilities may occupy [bytes].
    """

    def __init__(self, observation: HasRows, samples: int, memory: float) -> None:
        self._observation = observation
        ranges = partitions_of(observation, samples)
        self.partitions = tuple(HeldObservation(each, memory / len(ranges)) for each in ranges)
        self.samples = tuple(each.samples for each in ranges)

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self._observation.phase_centre

    def origin(self) -> Origin:
        """Return the origin of the observation that is held."""
        return origin_of(self._observation)

    def release(self) -> None:
        """Release the visibilities."""
        for each in self.partitions:
            each.release()

    def chunks(self) -> Iterator[Visibilities]:
        """Yield the chunks of all ranges; the whole must have a usable visibility."""
        total = SampleCounts()
        for each in self.partitions:
            for seen in each.chunks():
                if seen.counts is not None:
                    total += seen.counts
                yield seen
        self._observation.check_usable(total)


def held_by_parts(
    observation: Observation, memory: float, samples: int | None = None
) -> Observation:
    """Return an observation each of whose parts stays in memory if it fits into its share; all shares are equal.

    Parts in files are divided into ranges of at most this number of samples.
    """
    parts = parts_of(observation)
    share = memory / len(parts)
    held = tuple(
        HeldPartitions(part, samples, share)
        if samples is not None and isinstance(part, HasRows)
        else HeldObservation(part, share)
        for part in parts
    )
    return held[0] if len(held) == 1 else JointObservation(observation.phase_centre, held)


def held(observation: Observation, memory: float) -> Observation:
    """Return an observation that stays in memory if it fits; it may do so already, range by range."""
    return observation if _has_ranges(observation) else HeldObservation(observation, memory)


def blocks_of(observation: Observation, samples: int) -> Sequence[Observation] | None:
    """Divide an observation into blocks of consecutive ranges that have at most this number of samples together.

    None is returned for an observation that is not held range by range.
    """
    if not _has_ranges(observation):
        return None
    blocks: list[list[HeldObservation]] = [[]]
    left = samples
    for part in parts_of(observation):
        assert isinstance(part, HeldPartitions)
        for each, count in zip(part.partitions, part.samples, strict=True):
            if blocks[-1] and count > left:
                blocks.append([])
                left = samples
            blocks[-1].append(each)
            left -= count
    centre = observation.phase_centre
    return [
        block[0] if len(block) == 1 else JointObservation(centre, tuple(block)) for block in blocks
    ]


def _has_ranges(observation: Observation) -> bool:
    return all(isinstance(part, HeldPartitions) for part in parts_of(observation))


def release(observation: Observation) -> None:
    """Release the visibilities of the parts that stay in memory; another pass reads them again."""
    for part in parts_of(observation):
        if isinstance(part, HeldObservation | HeldPartitions):
            part.release()


def _bytes_of(chunk: Visibilities) -> int:
    arrays = [chunk.uvw, chunk.stokes_i, chunk.weights]
    if (seen := chunk.integrations) is not None:
        arrays += [seen.antennas, seen.time, seen.interval]
    return sum(array.nbytes for array in arrays)
