"""Tasks that use the results of earlier tasks."""

import time

import pytest

from uvshear.execution import SERIAL, Executor, Promise, Threads


@pytest.mark.parametrize("executor", [SERIAL, Threads(1), Threads(3)])
def test_a_later_task_gets_the_value_of_an_earlier_one(executor: Executor) -> None:
    promises = [Promise[int]() for _ in range(6)]

    def work(task: int) -> int:
        def found() -> int:
            time.sleep(0.01)
            return 1 + (promises[task - 1].value() if task else 0)

        promises[task].keep(found)
        return promises[task].value()

    assert list(executor.map(work, range(6))) == [1, 2, 3, 4, 5, 6]


@pytest.mark.parametrize("executor", [SERIAL, Threads(2)])
def test_an_error_reaches_the_tasks_that_wait(executor: Executor) -> None:
    promise, ended = Promise[float](), []

    def work(task: int) -> None:
        if task == 0:
            promise.keep(lambda: 1 / 0)
        try:
            promise.value()
        except ZeroDivisionError:
            ended.append(task)
            raise

    with pytest.raises(ZeroDivisionError):
        list(executor.map(work, range(2)))
    assert set(ended) <= {1}
