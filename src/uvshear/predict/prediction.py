"""The base class of predictions of visibilities that have been planned."""

from abc import ABC, abstractmethod

from uvshear.execution import SERIAL, Executor
from uvshear.progress import Progress
from uvshear.typing import Array, Complex


class Prediction(ABC):
    """Visibilities of galaxies that have yet to be predicted, and the work that this takes."""

    @property
    @abstractmethod
    def cost(self) -> float:
        """Estimated time on one core [ns]."""

    @abstractmethod
    def visibilities(
        self, executor: Executor = SERIAL, progress: Progress | None = None
    ) -> Complex[Array, "row chan"]:
        """Predict the visibilities [Jy]; they are the same for every executor, bit for bit.

        ``progress`` is called after each task with the time that the work has taken and that all of it takes, both as
        they were estimated [ns].
        """
