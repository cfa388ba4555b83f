"""Results of a pool of workers in the order of the tasks, with few tasks begun ahead."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor as Pool
from concurrent.futures import Future
from itertools import islice
from typing import Final

from uvshear.execution.crew import Result, Task

AHEAD: Final = 3
"""Number of tasks per worker that are begun or finished while the oldest result has not been yielded. With fewer,
workers would wait for a task that takes longer than those after it; with more, results would take more memory."""


def ordered_results(
    pool: Pool, workers: int, function: Callable[[Task], Result], tasks: Iterable[Task]
) -> Iterator[Result]:
    """Yield ``function(task)`` for every task; ``AHEAD`` tasks for each worker are begun in advance.

    When a task fails, or no more results are requested, tasks that have not begun are cancelled.
    """
    waiting = iter(tasks)
    begun: deque[Future[Result]] = deque(
        pool.submit(function, task) for task in islice(waiting, AHEAD * workers)
    )
    try:
        while begun:
            result = begun.popleft().result()
            begun.extend(pool.submit(function, task) for task in islice(waiting, 1))
            yield result
    finally:
        for future in begun:
            future.cancel()
