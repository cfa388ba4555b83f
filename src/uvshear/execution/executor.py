"""What an executor offers: work side by side, with results in the order of the tasks."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

Task = TypeVar("Task")
Shared = TypeVar("Shared")
Result = TypeVar("Result")


class Executor(ABC):
    """Runs tasks that do not depend on one another.

    Results come in the order of the tasks, so that a sum of them is the same, bit for bit, whatever the executor and
    however many workers it has.
    """

    @property
    @abstractmethod
    def workers(self) -> int:
        """Number of tasks that run side by side."""

    @abstractmethod
    def at_most(self, workers: int) -> "Executor":
        """Return an executor of this kind with no more workers than this, for tasks that need much memory each."""

    @abstractmethod
    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield ``function(task)`` of every task; all of them see the memory of this process.

        Tasks are taken from the iterable as they are begun, so that a generator of large tasks is never held as a
        whole.
        """

    @abstractmethod
    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield ``function(shared, task)`` of every task, which may run in another process.

        ``function`` is a function of a module; ``shared`` is sent to each worker once. Both, and tasks and results,
        can be pickled.
        """
