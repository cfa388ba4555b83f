"""Threads of linear algebra."""

import os
import subprocess
import sys

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


STARTED = """
from uvshear.execution import start_libraries_with_one_thread
start_libraries_with_one_thread()
import numpy, scipy.linalg
from threadpoolctl import threadpool_info
print(*(pool["num_threads"] for pool in threadpool_info()))
"""


def test_libraries_that_are_loaded_later_start_with_one_thread() -> None:
    names = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
    environment = {name: value for name, value in os.environ.items() if name not in names}
    for wanted, more in (("1", {}), ("2", {"OPENBLAS_NUM_THREADS": "2"})):
        found = subprocess.run(
            [sys.executable, "-c", STARTED],
            env=environment | more,
            check=True,
            capture_output=True,
            text=True,
        )
        assert set(found.stdout.split()) == {wanted}
