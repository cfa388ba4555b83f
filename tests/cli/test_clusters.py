"""Commands whose work is shared by the workers of a Dask cluster: on loopback, each worker a process."""

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

from tests.cli.processes import COMMAND, environment, started, wait_for
from tests.clusters import Cluster, cluster
from uvshear.io.observations import open_observation

BIAS = "bias --estimator moments --galaxies 200 --integration-s 3600 --seed 2 --threads 1"


@pytest.fixture
def own_cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    """A cluster of two workers that a test may end."""
    with cluster(tmp_path_factory.mktemp("cluster")) as found:
        yield found


def _ran(*words: str | Path) -> None:
    done = subprocess.run(
        [*COMMAND, *map(str, words)], capture_output=True, check=False, text=True, env=environment()
    )
    assert done.returncode == 0, done.stderr


def _ran_while_a_worker_is_killed(own_cluster: Cluster, *words: str | Path) -> None:
    with started(*words, "--scheduler", own_cluster.address) as running:
        wait_for(lambda: any(_tasks(own_cluster).values()))
        busy = next(process for process, count in _tasks(own_cluster).items() if count)
        own_cluster.kill(busy)
        _, told = running.communicate(timeout=120)
        assert running.returncode == 0, told


def _tasks(found: Cluster) -> dict[int, int]:
    """Count the tasks that each worker, given by its process, has at the moment."""
    return _of_scheduler(found, _processing)


def _processing(dask_scheduler) -> dict[int, int]:
    workers = dask_scheduler.workers.values()
    return {worker.pid: len(worker.processing) for worker in workers}


def _of_scheduler(found: Cluster, function: Callable) -> dict:
    from distributed import Client

    with Client(found.address, set_as_default=False) as client:
        return client.run_on_scheduler(function)


def _assert_same_table(one: Path, other: Path) -> None:
    first, second = Table.read(one), Table.read(other)
    assert first.colnames == second.colnames
    for name in first.colnames:
        for value, other_value in zip(first[name], second[name], strict=True):
            assert np.asarray(value).tobytes() == np.asarray(other_value).tobytes(), name


def _figures(path: Path) -> dict[str, object]:
    record = json.loads(path.read_text(encoding="utf-8"))
    return {name: value for name, value in record.items() if name not in ("provenance", "date")}


def test_shapes_and_statistics_are_the_same_with_a_cluster_that_loses_a_worker(
    own_cluster: Cluster, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    words = ["measure", field, "--catalogue", catalogue, "--keep", "moments,bayesian"]
    _ran(*words, "--threads", "1", "-o", tmp_path / "serial.fits")
    _ran(*words, "--threads", "2", "-o", tmp_path / "copies.fits")
    _ran_while_a_worker_is_killed(
        own_cluster, *words, "--threads", "1", "-o", tmp_path / "cluster.fits"
    )
    for kind in ("", ".stats", ".sky"):
        for name in ("copies", "cluster"):
            _assert_same_table(tmp_path / f"serial{kind}.fits", tmp_path / f"{name}{kind}.fits")


def test_the_bias_is_the_same_with_a_cluster_that_loses_a_worker(
    own_cluster: Cluster, tmp_path: Path
) -> None:
    _ran(*BIAS.split(), "-o", tmp_path / "serial.json")
    _ran_while_a_worker_is_killed(own_cluster, *BIAS.split(), "-o", tmp_path / "cluster.json")
    assert _figures(tmp_path / "cluster.json") == _figures(tmp_path / "serial.json")


def test_averages_are_the_same_with_a_cluster_that_loses_a_worker(
    own_cluster: Cluster, tmp_path: Path, field: Path
) -> None:
    words = ["average", field, "--field-arcmin", "4"]
    _ran(*words, "--threads", "1", "-o", tmp_path / "serial.ms")
    _ran_while_a_worker_is_killed(own_cluster, *words, "-o", tmp_path / "cluster.ms")
    one, other = (
        list(open_observation(tmp_path / f"{name}.ms").chunks()) for name in ("serial", "cluster")
    )
    for seen, same in zip(one, other, strict=True):
        for name in ("uvw", "stokes_i", "weights"):
            assert getattr(seen, name).tobytes() == getattr(same, name).tobytes()


def test_an_interruption_ends_the_command_and_its_tasks(
    own_cluster: Cluster, tmp_path: Path
) -> None:
    words = [*BIAS.replace("200", "100000").split(), "--scheduler", own_cluster.address]
    with started(*words, "-o", tmp_path / "bias.json") as running:
        wait_for(lambda: all(_tasks(own_cluster).values()))
        running.send_signal(signal.SIGINT)
        _, told = running.communicate(timeout=30)
        assert running.returncode == 130
        assert told == "uvshear: interrupted; unfinished outputs have been removed\n"
    wait_for(lambda: not any(_tasks(own_cluster).values()), 30)
    assert not (tmp_path / "bias.json").exists()


def test_a_scheduler_that_is_lost_ends_the_command_with_one_line(
    own_cluster: Cluster, tmp_path: Path
) -> None:
    words = [*BIAS.replace("200", "100000").split(), "--scheduler", own_cluster.address]
    with started(*words, "-o", tmp_path / "bias.json") as running:
        wait_for(lambda: all(_tasks(own_cluster).values()))
        own_cluster.scheduler.kill()
        _, told = running.communicate(timeout=60)
        assert running.returncode == 2
        assert told == "uvshear: error: the scheduler of the cluster no longer answers\n"
    assert not (tmp_path / "bias.json").exists()


@pytest.mark.parametrize("command", ["measure", "bias", "average"])
def test_a_scheduler_that_cannot_be_reached_is_told_before_work_starts(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, command: str
) -> None:
    words = {
        "measure": ("measure", field, "--catalogue", catalogue),
        "bias": (*BIAS.split(), "--galaxies", "100000000"),
        "average": ("average", field, "--field-arcmin", "4"),
    }[command]
    output = tmp_path / ("out.json" if command == "bias" else "out.fits")
    outcome = uvshear(*words, "--scheduler", "127.0.0.1:9", "-o", output)
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1
    assert "--scheduler 127.0.0.1:9: no Dask scheduler has answered at this address" in outcome.err
    assert not output.exists()


def test_without_a_scheduler_nothing_of_dask_is_imported(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "from uvshear.cli.application import run\n"
        f"assert run({[*BIAS.replace('200', '100').split(), '-o', str(tmp_path / 'b.json')]}) == 0\n"
        "assert not {'dask', 'distributed', 'tornado'} & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        check=False,
        text=True,
        env=environment(),
    )
    assert done.returncode == 0, done.stderr
