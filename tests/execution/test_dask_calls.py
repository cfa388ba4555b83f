"""Calls whose workers are lost on the way."""

import pytest

from tests.clusters import cluster
from tests.execution import tasks as work
from uvshear.execution import Dask, Serial, connected, dask_calls
from uvshear.execution.dask_calls import MOST_IN_A_BATCH, QUEUED, DaskCall


def test_a_worker_that_is_killed_costs_only_its_tasks(tmp_path) -> None:
    with cluster(tmp_path) as found, connected(found.address) as client:
        results = []
        for number, result in enumerate(
            Dask(client, Serial()).distribute(work.brief, 1, range(300))
        ):
            results.append(result)
            if number == 20:
                found.kill(found.workers[0].pid)
    assert [task for task, _ in results] == list(range(300))
    assert len({process for _, process in results[-20:]}) == 1


def test_a_cluster_that_has_lost_all_workers_goes_on_with_a_new_one(tmp_path) -> None:
    with cluster(tmp_path, workers=1) as found, connected(found.address) as client:
        results = []
        for number, result in enumerate(
            Dask(client, Serial()).distribute(work.brief, 1, range(200))
        ):
            results.append(result)
            if number == 20:
                found.kill(found.workers[0].pid)
                found.start_worker()
    assert [task for task, _ in results] == list(range(200))
    assert len({process for _, process in results}) == 2


def test_small_tasks_are_sent_together_and_the_last_ones_are_few(client, monkeypatch) -> None:
    sizes = []
    begin = DaskCall._begin
    monkeypatch.setattr(
        DaskCall, "_begin", lambda call, batch: (sizes.append(len(batch.tasks)), begin(call, batch))
    )
    monkeypatch.setattr(dask_calls, "_last_duration", {})
    executor = Dask(client, Serial())
    assert list(executor.distribute(work.affine, 1, range(2000))) == list(range(1, 2001))
    assert sum(sizes) == 2000
    assert sizes[: 2 * QUEUED] == [1] * 2 * QUEUED  # their duration is not known yet
    assert 10 < max(sizes) <= MOST_IN_A_BATCH
    assert sizes[-1] <= 2
    assert len(sizes) < 100


def test_tasks_that_nobody_waits_for_are_cancelled(client) -> None:
    results = Dask(client, Serial()).distribute(work.slow_first, None, range(1000))
    next(results)
    results.close()
    held = [key for keys in client.has_what().values() for key in keys]
    assert not client.futures
    assert len(held) <= QUEUED * 2


def test_libraries_of_the_caller_see_the_error_of_the_task_itself(client) -> None:
    with pytest.raises(ValueError, match="task 3"):
        list(Dask(client, Serial()).distribute(work.failing, None, range(5)))
