"""Tasks in parallel threads of this process."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from uvshear.execution.counted import Counted
from uvshear.execution.crew import Result, Shared, Task
from uvshear.execution.ordered import ordered_results


@dataclass(frozen=True)
class Threads(Counted):
    """Runs tasks in ``count`` threads, which share memory and, outside compiled code, the interpreter's lock."""

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the results; few tasks are begun ahead of them (``ordered.AHEAD``)."""
        with ThreadPoolExecutor(self.count) as pool:
            yield from ordered_results(pool, self.count, function, tasks)

    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results, from the same threads."""
        return self.map(partial(function, shared), tasks)
