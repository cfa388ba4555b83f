"""Work side by side whose results come in the order it was given: sums do not depend on the threads."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")


def in_order(
    function: Callable[[Task], Result], tasks: Iterable[Task], threads: int
) -> Iterator[Result]:
    """Yield function(task) for each task in turn; at most ``threads`` + 1 are begun ahead."""
    if threads <= 1:
        yield from map(function, tasks)
        return
    waiting = iter(tasks)
    with ThreadPoolExecutor(threads) as pool:
        begun: deque[Future[Result]] = deque(
            pool.submit(function, task) for task in islice(waiting, threads + 1)
        )
        while begun:
            result = begun.popleft().result()
            begun.extend(pool.submit(function, task) for task in islice(waiting, 1))
            yield result
