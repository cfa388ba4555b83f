"""Tasks in parallel processes, for work that holds Python's global interpreter lock."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from typing import Any

from uvshear.errors import InputError
from uvshear.execution.executor import Executor, Result, Shared, Task
from uvshear.execution.libraries import limit_libraries
from uvshear.execution.ordered import ordered_results
from uvshear.execution.threads import Threads


@dataclass(frozen=True)
class Processes(Executor):
    """Distributes tasks over ``count`` processes; tasks that share memory run in as many threads."""

    count: int

    def __post_init__(self) -> None:
        if self.count < 1:
            raise InputError(f"{self.count} processes; one or more are needed")

    @property
    def workers(self) -> int:
        """Number of processes."""
        return self.count

    def at_most(self, workers: int) -> "Processes":
        """Return an executor with at most this number of processes, and at least one."""
        return Processes(max(1, min(self.count, workers)))

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the results, from threads of this process."""
        return Threads(self.count).map(function, tasks)

    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results; each process gets ``shared`` when it starts."""
        with ProcessPoolExecutor(
            self.count,
            mp_context=get_context("spawn"),
            initializer=_begin,
            initargs=(function, shared),
        ) as pool:
            yield from ordered_results(pool, self.count, _work, tasks)


_job: list[Callable[[Any], Any]] = []


def _begin(function: Callable[[Any, Any], Any], shared: object) -> None:
    limit_libraries()
    _job[:] = [partial(function, shared)]


def _work(task: Any) -> Any:
    return _job[0](task)
