"""Workers that share an object for a while, and are told how it changes between their tasks."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Generic, TypeVar

Task = TypeVar("Task")
Shared = TypeVar("Shared")
Result = TypeVar("Result")

Map = Callable[[Callable[[Any], Any], Iterable[Any]], Iterator[Any]]
"""The map of an executor."""


class Crew(ABC, Generic[Shared]):
    """Workers that hold the same object."""

    @abstractmethod
    def map(
        self, function: Callable[[Shared, Task], Result], tasks: Iterable[Task]
    ) -> Iterator[Result]:
        """Yield ``function(shared, task)`` for every task, in order.

        ``function`` is defined in a module; tasks and results are picklable.
        """

    @abstractmethod
    def tell(self, change: Callable[..., None], *news: Any) -> None:
        """Call ``change(shared, *news)`` for the object of every worker that has one of its own, before its next task.

        The object of this process is not changed: whoever tells has done so.
        """


class LocalCrew(Crew[Shared]):
    """Workers that use the object of this process itself."""

    def __init__(self, shared: Shared, run: Map) -> None:
        self._shared, self._run = shared, run

    def map(
        self, function: Callable[[Shared, Task], Result], tasks: Iterable[Task]
    ) -> Iterator[Result]:
        """Yield the results."""
        return self._run(lambda task: function(self._shared, task), tasks)

    def tell(self, change: Callable[..., None], *news: Any) -> None:
        """Do nothing: all have the same object."""
