"""Results of a pool of workers in the order of the tasks, with few tasks begun ahead."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor as Pool
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import Final

from uvshear.execution.crew import Result, Task

AHEAD: Final = 2
"""Number of tasks per worker that are with the pool, waiting or finished, while the oldest result has not been yielded.
With fewer, workers would wait for a task that takes longer than those after it; with more, results would take more
memory."""


def ordered_results(
    pool: Pool, workers: int, function: Callable[[Task], Result], tasks: Iterable[Task]
) -> Iterator[Result]:
    """Yield ``function(task)`` for every task; the pool has at most ``AHEAD`` tasks for each worker at a time.

    When a task fails, or no more results are requested, tasks that have not begun are cancelled. The pool is used for
    these tasks alone.
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
        _cancel(pool, begun)


def _cancel(pool: Pool, begun: Iterable[Future[Result]]) -> None:
    """Cancel the tasks that no worker has taken.

    A thread takes a task a moment before it marks it as running. In that moment the task can still be cancelled, and a
    later one, which runs already, may wait for it (``Promise``). From a pool of threads, only those are removed that
    nobody has taken.
    """
    if isinstance(pool, ThreadPoolExecutor):
        pool.shutdown(wait=False, cancel_futures=True)
    else:
        for future in begun:
            future.cancel()
