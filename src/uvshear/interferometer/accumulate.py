"""One pass over the visibilities of an observation, for everything that is to be learnt from it."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Generic, Self, TypeVar

from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.visibilities import Observation, Visibilities

Result = TypeVar("Result", covariant=True)


class Accumulator(ABC, Generic[Result]):
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
    def result(self) -> Result:
        """Return what was gathered."""


def accumulate(
    observation: Observation,
    accumulators: Sequence[Accumulator[Any]],
    executor: Executor = SERIAL,
) -> tuple[Any, ...]:
    """Read the observation once, show every chunk to all accumulators side by side, and return their results."""
    for seen in observation.chunks():

        def add(accumulator: Accumulator[Any], seen: Visibilities = seen) -> None:
            accumulator.add(seen)

        for _ in executor.map(add, accumulators):
            pass
    return tuple(accumulator.result() for accumulator in accumulators)
