"""What every executor promises."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.execution import tasks as work
from uvshear.execution import (
    Copies,
    Dask,
    Executor,
    Processes,
    Serial,
    Threads,
    copied_crew,
    dask_calls,
    ordered,
)

IN_THREADS = [Serial(), Threads(1), Threads(2), Threads(3)]
LOCAL = [*IN_THREADS, Processes(2), Copies(2)]
each = pytest.mark.parametrize("executor", [*LOCAL, "Dask"], ids=str, indirect=True)


@pytest.fixture
def executor(request: pytest.FixtureRequest) -> Executor:
    """Return an executor of this machine, or the one of a cluster of two workers."""
    if request.param == "Dask":
        return Dask(request.getfixturevalue("client"), Copies(2))
    return request.param


@pytest.mark.parametrize("executor", IN_THREADS, ids=repr)
@settings(deadline=None, max_examples=20)
@given(st.lists(st.integers(), max_size=12))
def test_results_are_those_of_a_loop(executor: Executor, tasks: list[int]) -> None:
    expected = [3 * task + 1 for task in tasks]
    assert list(executor.map(lambda task: 3 * task + 1, tasks)) == expected
    assert list(executor.distribute(work.affine, 3, tasks)) == expected


@each
def test_results_come_in_the_order_of_the_tasks(executor: Executor) -> None:
    assert list(executor.map(lambda task: task**2, range(9))) == [task**2 for task in range(9)]
    assert list(executor.distribute(work.affine, 5, range(9))) == [
        5 * task + 1 for task in range(9)
    ]


@each
def test_there_may_be_no_task(executor: Executor) -> None:
    assert list(executor.map(str, [])) == []
    assert list(executor.distribute(work.affine, 1, [])) == []


@each
def test_an_error_reaches_the_caller_after_the_results_before_it(executor: Executor) -> None:
    for results in (
        executor.map(lambda task: 1 // task, [1, 0, 1]),
        executor.distribute(work.inverse, 1, [1, 0, 1]),
    ):
        assert next(results) == 1
        with pytest.raises(ZeroDivisionError):
            next(results)


@each
def test_all_executors_agree_bit_by_bit(executor: Executor) -> None:
    shared = np.random.default_rng(1).normal(size=10_001)
    expected = [work.own_sum(shared, task) for task in range(5)]
    assert list(executor.map(lambda task: work.own_sum(shared, task), range(5))) == expected
    assert list(executor.distribute(work.own_sum, shared, range(5))) == expected


@each
def test_few_tasks_are_begun_ahead(executor: Executor) -> None:
    begun = []

    def tasks():
        for task in range(40):
            begun.append(task)
            yield task

    for results in (
        executor.map(lambda task: task, tasks()),
        executor.distribute(work.affine, 1, tasks()),
    ):
        begun.clear()
        ahead = [len(begun) - count for count, _ in enumerate(results, start=1)]
        # Large tasks wait in memory: without a bound all of them would.
        per_worker = {
            Serial: 0,
            Copies: copied_crew.AHEAD,
            Dask: dask_calls.AHEAD,
        }.get(type(executor), ordered.AHEAD)
        assert max(ahead) <= per_worker * executor.workers


@pytest.mark.parametrize("executor", [Serial(), Copies(2)])
@pytest.mark.parametrize("number", [0, 1, 7, 12])
def test_small_tasks_that_come_together_have_the_same_results(executor, number) -> None:
    found = executor.map_in_batches(lambda task: task**2, range(number), 4)
    assert list(found) == [task**2 for task in range(number)]


@each
@pytest.mark.parametrize("number", [1, 9, 20])
def test_sums_over_partitions_agree_bit_by_bit(executor: Executor, number: int) -> None:
    shared = np.random.default_rng(1).normal(size=1001)
    expected = Serial().sum_partitions(work.waves, work.added, shared, range(number))
    found = executor.sum_partitions(work.waves, work.added, shared, range(number))
    assert found.tobytes() == expected.tobytes()
    one_by_one = list(executor.in_partitions(work.read, work.waves_of_data, shared, range(number)))
    np.testing.assert_allclose(np.sum(one_by_one, axis=0), found, rtol=1e-12, atol=1e-12)


@each
def test_the_error_of_a_partition_reaches_the_caller(executor: Executor) -> None:
    with pytest.raises(ValueError, match="task 3"):
        executor.sum_partitions(work.failing, work.added, None, range(9))
    with pytest.raises(ValueError, match="task 3"):
        list(executor.in_partitions(work.read, work.failing_of_data, None, range(9)))
