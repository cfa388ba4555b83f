import threading
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from uvshear.execution.concurrency import in_order


@settings(deadline=None, max_examples=30)
@given(st.lists(st.integers(), max_size=12), st.integers(0, 4))
def test_results_are_those_of_a_loop_whatever_the_threads(tasks, threads):
    assert list(in_order(lambda x: 3 * x + 1, tasks, threads)) == [3 * x + 1 for x in tasks]


def test_results_come_in_the_order_given_though_the_first_task_ends_last():
    ended = []

    def wait(task):
        time.sleep(0.03 if task == 0 else 0.0)
        ended.append(task)
        return task

    assert list(in_order(wait, range(4), 3)) == [0, 1, 2, 3]
    assert ended[0] != 0  # it did end after others: the order is not an accident


def test_two_threads_work_at_the_same_time():
    both = threading.Barrier(2, timeout=5)
    # one after the other, the first would wait for the second until the barrier breaks
    assert sorted(in_order(lambda _: both.wait(), range(2), 2)) == [0, 1]


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_no_more_than_one_task_over_the_threads_is_begun_ahead(threads):
    begun = []

    def tasks():
        for task in range(12):
            begun.append(task)
            yield task

    ahead = []
    for count, _ in enumerate(in_order(lambda x: x, tasks(), threads), start=1):
        ahead.append(len(begun) - count)
    # images of tiles wait in memory: without a bound all twelve would
    assert max(ahead) == (0 if threads == 1 else threads + 1)


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_reaches_who_asked_after_the_results_before_it(threads):
    got = []
    with pytest.raises(ZeroDivisionError):
        got.extend(in_order(lambda x: 1 // x, [1, 0, 1], threads))
    results = in_order(lambda x: 1 // x, [1, 0, 1], threads)
    assert next(results) == 1
    with pytest.raises(ZeroDivisionError):
        next(results)
