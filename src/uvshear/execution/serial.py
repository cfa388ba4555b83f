"""One task after the other."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from uvshear.execution.crew import Result, Shared, Task
from uvshear.execution.executor import Executor


@dataclass(frozen=True)
class Serial(Executor):
    """Runs every task in the thread that asks for its result."""

    @property
    def workers(self) -> int:
        """One."""
        return 1

    def at_most(self, workers: int) -> "Serial":
        """Return the same executor: there is no smaller one."""
        return self

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the results one by one, each computed when it is asked for."""
        return map(function, tasks)

    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results one by one, each computed when it is asked for."""
        return (function(shared, task) for task in tasks)
