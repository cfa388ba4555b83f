"""One pass over the visibilities of an observation, for everything that is to be learnt from it."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any, Generic, Self, TypeVar

from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.visibilities import Observation, Visibilities

Result_co = TypeVar("Result_co", covariant=True)


class Accumulator(ABC, Generic[Result_co]):
    """Gathers something from visibilities, chunk by chunk.

    A pass may be divided: each part has an accumulator of its own, and these are merged in the order of the
    visibilities.
    """

    @abstractmethod
    def add(self, seen: Visibilities) -> None:
        """Take in the next chunk."""

    @abstractmethod
    def merge(self, later: Self) -> None:
        """Take in what another accumulator of this kind has gathered from later visibilities."""

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
    """Read the observation once, show every chunk to all accumulators side by side, and return their results."""
    show(observation.chunks(), accumulators, executor)
    return tuple(accumulator.result() for accumulator in accumulators)


def show(
    chunks: Iterable[Visibilities],
    accumulators: Sequence[Accumulator[Any]],
    executor: Executor = SERIAL,
) -> None:
    """Show chunks to all accumulators side by side, and leave the results for later."""
    for seen in chunks:

        def add(accumulator: Accumulator[Any], seen: Visibilities = seen) -> None:
            accumulator.add(seen)

        for _ in executor.map(add, accumulators):
            pass
        if accumulators and all(accumulator.is_satisfied for accumulator in accumulators):
            break
