"""A pool of workers that share an object for a while, and receive its changes between tasks."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Generic, TypeVar

Task = TypeVar("Task")
Shared = TypeVar("Shared")
Result = TypeVar("Result")
Data = TypeVar("Data")

Map = Callable[[Callable[[Any], Any], Iterable[Any]], Iterator[Any]]
"""The map of an executor."""


class Crew(ABC, Generic[Shared]):
    """Workers that hold the same object."""

    @abstractmethod
    def map(
        self, function: Callable[[Shared, Task], Result], tasks: Iterable[Task]
    ) -> Iterator[Result]:
        """Yield ``function(shared, task)`` for every task, in order.

        ``function`` is defined at the top level of a module, so that it can be pickled. Tasks and results are
        picklable.
        """

    @abstractmethod
    def tell(self, change: Callable[..., None], *news: Any) -> None:
        """Call ``change(shared, *news)`` in every worker that has its own copy of the object, before its next task.

        The object of this process is not changed; the caller does that.
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
