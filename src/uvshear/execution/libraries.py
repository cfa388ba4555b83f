"""Threads that libraries start by themselves, those of linear algebra above all."""

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


def limit_libraries() -> None:
    """Leave libraries one thread each, for as long as the process lives."""
    threadpool_limits(1)


@contextmanager
def single_threaded_libraries() -> Iterator[None]:
    """Leave libraries one thread each within the block.

    Theirs would compete with an executor's for the cores, and change the last bits of a sum.
    """
    with threadpool_limits(1):
        yield
