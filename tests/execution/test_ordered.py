"""Order and bounds of what a pool is given."""

import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from uvshear.execution.ordered import ordered_results


def test_tasks_that_have_not_begun_are_given_up_after_an_error() -> None:
    done = []

    def work(task: int) -> None:
        time.sleep(0.02)
        if task == 0:
            raise ZeroDivisionError
        done.append(task)

    with ThreadPoolExecutor(1) as pool, pytest.raises(ZeroDivisionError):
        list(ordered_results(pool, 3, work, range(10)))
    assert len(done) < 3
