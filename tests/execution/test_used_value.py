"""Values that several tasks use."""

import time

import pytest

from uvshear.execution import SERIAL, Executor, Threads, UsedValue


@pytest.mark.parametrize("executor", [SERIAL, Threads(3)])
def test_a_value_is_worked_out_once_and_released_after_its_last_use(executor: Executor) -> None:
    made = []

    def work_out() -> int:
        time.sleep(0.02)
        made.append(1)
        return 7

    value = UsedValue[int]()
    for _ in range(4):
        value.announce_use()
    assert not value.is_held

    def use(task: int) -> tuple[int, bool]:
        with value.used(work_out) as found:
            return found + task, value.is_held

    assert list(executor.map(use, range(3))) == [(7, True), (8, True), (9, True)]
    assert value.is_held
    with value.used(work_out) as found:
        assert found == 7
    assert made == [1]
    assert not value.is_held
