"""A Dask cluster on the loopback interface: a scheduler and workers, each a process of its own."""

import ctypes
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import uvshear

ROOT = Path(__file__).parents[1]
PACKAGE = Path(uvshear.__file__).parents[1]


@dataclass
class Cluster:
    """A scheduler and its workers."""

    directory: Path
    environment: dict[str, str]
    scheduler: "subprocess.Popen[bytes]"
    address: str
    workers: "list[subprocess.Popen[bytes]]" = field(default_factory=list)

    def start_worker(self) -> "subprocess.Popen[bytes]":
        """Start a worker with one thread, without the nanny that would start it again."""
        words = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "30"]
        process = _started("worker", [self.address, *words], self.directory, self.environment)
        self.workers.append(process)
        return process

    def kill(self, process: int) -> None:
        """Kill a worker by SIGKILL, as the system does when memory runs out."""
        (worker,) = (each for each in self.workers if each.pid == process)
        worker.send_signal(signal.SIGKILL)
        worker.wait(10)


@contextmanager
def cluster(directory: Path, workers: int = 2, **environment: str) -> Iterator[Cluster]:
    """Start a cluster, and end it. Variables of the environment are added for all of its processes."""
    file = directory / "scheduler.json"
    words = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", file]
    scheduler = _started("scheduler", words, directory, environment)
    found = None
    try:
        found = Cluster(directory, environment, scheduler, _address(file, scheduler))
        for _ in range(workers):
            found.start_worker()
        if workers:
            _wait_for_workers(found.address, workers)
        yield found
    finally:
        processes = [scheduler, *(found.workers if found else ())]
        for process in processes:
            process.kill()
        for process in processes:
            process.wait(10)


def _started(
    part: str, words: Sequence[object], directory: Path, environment: Mapping[str, str]
) -> "subprocess.Popen[bytes]":
    with (directory / "cluster.log").open("ab") as log:
        return subprocess.Popen(
            [sys.executable, "-m", f"distributed.cli.dask_{part}", *map(str, words)],
            stdout=log,
            stderr=log,
            cwd=directory,
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join([str(PACKAGE), str(ROOT)]),
                **environment,
            },
            # If the tests are killed, their scheduler ends, and its workers follow. A worker would end with the thread
            # that has started it.
            preexec_fn=_end_with_parent if part == "scheduler" else None,  # noqa: PLW1509
        )


def _end_with_parent() -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def _address(file: Path, scheduler: "subprocess.Popen[bytes]") -> str:
    end = time.monotonic() + 60
    while time.monotonic() < end and scheduler.poll() is None:
        try:
            return json.loads(file.read_text(encoding="utf-8"))["address"]
        except (OSError, ValueError):
            time.sleep(0.05)
    raise AssertionError("the scheduler has not started")


def _wait_for_workers(address: str, count: int) -> None:
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=60)
