"""Tasks in threads."""

import time

from tests.execution.tasks import Meeting
from uvshear.execution import Threads


def test_two_tasks_run_at_the_same_time() -> None:
    # One after the other, the first would wait for the second until it gives up.
    assert sorted(Threads(2).map(Meeting(), range(2))) == [0, 1]


def test_results_keep_their_order_though_the_first_task_ends_last() -> None:
    ended = []

    def wait(task: int) -> int:
        time.sleep(0.03 if task == 0 else 0.0)
        ended.append(task)
        return task

    assert list(Threads(3).map(wait, range(4))) == [0, 1, 2, 3]
    assert ended[0] != 0  # The order is not an accident.
