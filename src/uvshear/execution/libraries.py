"""Threads that libraries start by themselves, above all for linear algebra."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


def start_libraries_with_one_thread() -> None:
    """Let libraries that this process has not loaded yet start no threads, unless the environment says otherwise.

    Threads that a library starts look for work for a while, even if it is limited to one of them later.
    """
    for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(variable, "1")


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
