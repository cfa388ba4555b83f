"""Clusters that are lost."""

import os

import pytest

from tests.clusters import cluster
from tests.execution import tasks as work
from uvshear.execution import ClusterLost, Dask, Serial, connected, dask_calls


def test_a_task_that_ends_every_worker_ends_the_call_with_one_line(tmp_path) -> None:
    allowed = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
    with (
        cluster(tmp_path, workers=2, **allowed) as found,
        connected(found.address) as client,
        pytest.raises(ClusterLost, match="2 workers of the cluster ended during the same task"),
    ):
        list(Dask(client, Serial()).distribute(work.ended, os.getpid(), range(1)))


def test_a_cluster_without_a_worker_left_ends_the_call(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(dask_calls, "WAIT_FOR_WORKERS", 1.0)
    with cluster(tmp_path, workers=1) as found, connected(found.address) as client:
        results = Dask(client, Serial()).distribute(work.brief, 1, range(200))
        next(results)
        found.kill(found.workers[0].pid)
        with pytest.raises(ClusterLost, match="no worker of the cluster can be reached"):
            list(results)


def test_a_scheduler_that_ends_ends_the_call(tmp_path) -> None:
    with cluster(tmp_path, workers=1) as found, connected(found.address) as client:
        results = Dask(client, Serial()).distribute(work.brief, 1, range(200))
        next(results)
        found.scheduler.kill()
        with pytest.raises(ClusterLost, match="the scheduler of the cluster no longer answers"):
            list(results)
