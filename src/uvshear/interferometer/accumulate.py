"""One pass over the visibilities of an observation, shared by several computations."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any, Generic, Self, TypeVar

from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.screening import screened
from uvshear.interferometer.visibilities import Observation, Visibilities

Result_co = TypeVar("Result_co", covariant=True)


class Accumulator(ABC, Generic[Result_co]):
    """A computation that goes once over the visibilities, chunk by chunk.

    A pass may be divided: each part has an accumulator of its own, and these are merged in the order of the
    visibilities.
    """

    @abstractmethod
    def add(self, seen: Visibilities) -> None:
        """Add the next chunk."""

    @abstractmethod
    def merge(self, later: Self) -> None:
        """Add the sums of another accumulator of this kind over later visibilities."""

    @abstractmethod
    def result(self) -> Result_co:
        """Return what was gathered."""

    @property
    def is_satisfied(self) -> bool:
        """Whether further visibilities would change nothing; a pass ends when all of its accumulators are."""
        return False


def accumulate(
    observation: Observation,
    accumulators: Sequence[Accumulator[Any]],
    executor: Executor = SERIAL,
) -> tuple[Any, ...]:
    """Read the observation once, add every chunk to all accumulators in parallel, and return their results."""
    show(observation.chunks(), accumulators, executor)
    return tuple(accumulator.result() for accumulator in accumulators)


def show(
    chunks: Iterable[Visibilities],
    accumulators: Sequence[Accumulator[Any]],
    executor: Executor = SERIAL,
) -> None:
    """Add chunks to all accumulators in parallel, without asking for their results.

    Samples that cannot be right are left out (``screening``).
    """
    for seen in map(screened, chunks):

        def add(accumulator: Accumulator[Any], seen: Visibilities = seen) -> None:
            accumulator.add(seen)

        for _ in executor.map(add, accumulators):
            pass
        if accumulators and all(accumulator.is_satisfied for accumulator in accumulators):
            break
