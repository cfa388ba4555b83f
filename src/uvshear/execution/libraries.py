"""Threads that libraries start by themselves, above all for linear algebra."""

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


def limit_libraries() -> None:
    """Limit libraries to one thread each for the rest of the process."""
    threadpool_limits(1)


@contextmanager
def single_threaded_libraries() -> Iterator[None]:
    """Limit libraries to one thread each within the block.

    More threads would compete with those of an executor for the cores, and change the last bits of sums.
    """
    with threadpool_limits(1):
        yield
