"""The base class of observers of a long computation."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

from uvshear.progress.stage import Stage


class Observer(ABC):
    """Is told of the stages of a computation. It is passed where a function of the work done and the total work can be.

    A stage ends when another one begins, or when all is finished.
    """

    @abstractmethod
    def begin(self, stage: Stage, *then: Stage) -> None:
        """Hear that a stage begins, and which others are expected to follow."""

    @abstractmethod
    def advance(self, done: float, expected: float) -> None:
        """Hear how many units of the stage are done, and how many there will be in all."""

    @abstractmethod
    def foresee(self, *then: Stage) -> None:
        """Hear that these stages are now expected to follow the one that is under way."""

    @abstractmethod
    def note(self, facts: Mapping[str, object]) -> None:
        """Hear facts about the stage, such as how far it has converged, in numbers, words and lists."""

    @abstractmethod
    def finish(self) -> None:
        """Hear that the last stage has ended; others may begin later."""

    def __call__(self, done: int, total: int) -> None:
        """Hear how much of a computation without stages is done."""
        self.advance(done, total)
