"""The executor of a cluster."""

import os
import pickle
from pathlib import Path

import numpy as np

from tests.execution import tasks as work
from uvshear.execution import Copies, Dask, Serial


def test_distributed_tasks_run_on_the_workers(client) -> None:
    processes = {
        process for _, process in Dask(client, Serial()).distribute(work.brief, 0, range(40))
    }
    assert os.getpid() not in processes
    assert len(processes) == 2


def test_what_shares_memory_runs_on_this_machine(client, two_workers) -> None:
    executor = Dask(client, Copies(2))
    assert set(executor.map(lambda _: os.getpid(), range(4))) == {os.getpid()}
    with executor.lasting() as lasting, lasting.crew(os.getpid()) as crew:
        found = set(crew.map(work.long_in, range(20)))
    assert len(found) == 2
    assert os.getpid() in found
    assert not found & {worker.pid for worker in two_workers.workers}


def test_the_cores_of_the_cluster_are_not_those_of_this_machine(client) -> None:
    executor = Dask(client, Copies(3))
    assert (executor.workers, executor.distributed_workers) == (3, 2)
    fewer = executor.at_most(1)
    assert (fewer.workers, fewer.distributed_workers) == (1, 2)


def test_on_a_worker_it_is_serial(client) -> None:
    assert pickle.loads(pickle.dumps(Dask(client, Copies(2)))) == Serial()


def test_what_is_shared_is_pickled_once(client, tmp_path) -> None:
    shared = work.CountsItsPickles(tmp_path / "sent.txt")
    found = list(Dask(client, Serial()).distribute(work.nothing, shared, range(20)))
    assert found == list(range(20))
    assert shared.log.read_text() == "sent\n"


def test_what_is_large_does_not_go_through_the_scheduler(client, two_workers) -> None:
    """40 MB are shared and each of four results is 8 MB; the scheduler's memory does not grow by any of them."""
    executor = Dask(client, Serial())
    list(executor.distribute(work.large, np.zeros(1), range(2)))
    before = _peak_memory(two_workers.scheduler.pid)
    found = executor.distribute(work.large, np.zeros(5_000_000), range(4))
    assert [int(each[0]) for each in found] == list(range(4))
    assert _peak_memory(two_workers.scheduler.pid) - before < 4e6


def _peak_memory(process: int) -> float:
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    (peak,) = (line.split()[1] for line in lines if line.startswith("VmHWM"))
    return 1024.0 * int(peak)
