"""Threads of linear algebra."""

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from uvshear.execution import single_threaded_libraries


def _threads() -> list[int]:
    np.ones((2, 2)) @ np.ones((2, 2))
    return [pool["num_threads"] for pool in threadpool_info()]


def test_libraries_have_one_thread_within_the_block() -> None:
    with threadpool_limits(2):
        with single_threaded_libraries():
            assert set(_threads()) == {1}
        assert max(_threads()) == 2
