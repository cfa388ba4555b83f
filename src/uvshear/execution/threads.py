"""Tasks side by side in threads of this process."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import islice

from uvshear.errors import InputError
from uvshear.execution.executor import Executor, Result, Shared, Task


@dataclass(frozen=True)
class Threads(Executor):
    """Runs tasks in ``count`` threads, which share memory and, outside compiled code, the interpreter's lock."""

    count: int

    def __post_init__(self) -> None:
        if self.count < 1:
            raise InputError(f"{self.count} threads; one or more are needed")

    @property
    def workers(self) -> int:
        """Number of threads."""
        return self.count

    def at_most(self, workers: int) -> "Threads":
        """Return an executor of fewer threads if there are more than this, of one at least."""
        return Threads(max(1, min(self.count, workers)))

    def map(self, function: Callable[[Task], Result], tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the results; at most one task more than there are threads is begun ahead."""
        waiting = iter(tasks)
        with ThreadPoolExecutor(self.count) as pool:
            begun: deque[Future[Result]] = deque(
                pool.submit(function, task) for task in islice(waiting, self.count + 1)
            )
            while begun:
                result = begun.popleft().result()
                begun.extend(pool.submit(function, task) for task in islice(waiting, 1))
                yield result

    def distribute(
        self,
        function: Callable[[Shared, Task], Result],
        shared: Shared,
        tasks: Iterable[Task],
    ) -> Iterator[Result]:
        """Yield the results, from the same threads."""
        return self.map(partial(function, shared), tasks)
