"""Sums whose workers are lost on the way."""

import os
import threading
import time

import numpy as np
import pytest

from tests.clusters import cluster
from tests.execution import tasks as work
from uvshear.execution import ClusterLost, Dask, Serial, connected

SHARED = np.random.default_rng(1).normal(size=1001)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_sum_is_the_same_when_a_worker_or_the_only_one_is_killed(tmp_path, workers) -> None:
    expected = Serial().sum_partitions(work.waves, work.added, SHARED, range(60))
    with cluster(tmp_path, workers) as found, connected(found.address) as client:

        def kill() -> None:
            time.sleep(1.0)
            found.kill(found.workers[0].pid)
            found.start_worker()

        killer = threading.Thread(target=kill)
        killer.start()
        total = Dask(client, Serial()).sum_partitions(
            work.slow_waves, work.added, SHARED, range(60)
        )
        killer.join()
    assert total.tobytes() == expected.tobytes()


def test_nothing_of_a_sum_stays_on_the_cluster(client) -> None:
    Dask(client, Serial()).sum_partitions(work.waves, work.added, SHARED, range(20))
    end = time.monotonic() + 10
    while any(client.has_what().values()):
        assert time.monotonic() < end
        time.sleep(0.05)


def test_a_partition_that_ends_every_worker_ends_the_sum_with_one_line(tmp_path) -> None:
    allowed = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
    with (
        cluster(tmp_path, workers=2, **allowed) as found,
        connected(found.address) as client,
        pytest.raises(ClusterLost, match="1 worker of the cluster ended during the same task"),
    ):
        Dask(client, Serial()).sum_partitions(work.ended, work.added, os.getpid(), range(2))
