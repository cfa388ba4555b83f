"""Results of a pool of workers in the order of the tasks, with few tasks begun ahead."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor as Pool
from concurrent.futures import Future
from itertools import islice

from uvshear.execution.crew import Result, Task


def ordered_results(
    pool: Pool, workers: int, function: Callable[[Task], Result], tasks: Iterable[Task]
) -> Iterator[Result]:
    """Yield ``function(task)`` for every task; at most one task more than there are workers is begun in advance.

    When a task fails, or no more results are requested, tasks that have not begun are cancelled.
    """
    waiting = iter(tasks)
    begun: deque[Future[Result]] = deque(
        pool.submit(function, task) for task in islice(waiting, workers + 1)
    )
    try:
        while begun:
            result = begun.popleft().result()
            begun.extend(pool.submit(function, task) for task in islice(waiting, 1))
            yield result
    finally:
        for future in begun:
            future.cancel()
