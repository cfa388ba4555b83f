"""Predict how long a measurement takes on a Dask cluster, from the tasks and the bytes of a run with one worker.

    python benchmarks/cluster.py --record cluster
    python benchmarks/cluster.py --field-arcmin 12 --integration-s 900

The processor time of every task is recorded, and the size of what would be sent: the object that a call shares, and the
results. The schedule is then simulated. Tasks of ``distribute`` go to the workers of the cluster; ``map`` and crews,
that is, minor cycles and the major cycles of a single block, have the cores of the client's machine. A second schedule
lets the workers do these tasks as well, each call of them as a call of ``distribute``; it leaves out the samples and
images that would have to be sent, too. Memory bandwidth is neglected.
"""

import argparse
import heapq
import json
import math
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import survey
from record import RESULTS, write_record
from scaling import stage

import uvshear
from uvshear.execution import Crew, Executor, in_copies
from uvshear.execution.dask_calls import WORTH_A_BATCH
from uvshear.execution.parcel import Parcel
from uvshear.io.catalogue import catalogue_from_galaxies

WORKERS = (4, 16, 64, 256)

CORES_OF_A_MACHINE = 64
"""Largest number of cores of the client's machine."""

BANDWIDTH = 1.2e9
"""Bytes per second between two machines: 10 Gbit/s."""

LATENCY = 5e-3
"""Time from the end of a task until its worker has been told of the next, if none is queued, and of a call's start [s].
It was measured on loopback."""

BATCH = 1e-3
"""Time that the scheduler takes for a batch of tasks [s]."""

POINTINGS = 1000


@dataclass
class Call:
    """A call of an executor.

    Parameters
    ----------
    stage
        Stage of the measurement.
    is_distributed
        Whether its tasks may run on other machines.
    seconds
        Processor time of each task [s].
    shared
        Size of the object that the tasks share [bytes]; 0 for tasks that share memory.
    results
        Size of all results [bytes].
    """

    stage: str
    is_distributed: bool
    seconds: list[float] = field(default_factory=list)
    shared: int = 0
    results: int = 0


@dataclass
class Measured(Executor):
    """Runs one task after the other, and notes times and sizes; ``overhead`` is the time that this takes [s]."""

    calls: list[Call] = field(default_factory=list)
    overhead: float = 0.0

    @property
    def workers(self) -> int:
        """One."""
        return 1

    def at_most(self, workers: int) -> "Measured":
        """Return this executor."""
        return self

    def map(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Iterator[Any]:
        """Yield the results, each computed when it is asked for."""
        return self._run(Call(stage(sys._getframe(1)), is_distributed=False), function, tasks)

    def distribute(
        self, function: Callable[[Any, Any], Any], shared: object, tasks: Iterable[Any]
    ) -> Iterator[Any]:
        """Yield the results, each computed when it is asked for."""
        call = Call(stage(sys._getframe(1)), is_distributed=True, shared=self._size(shared))
        return self._run(call, lambda task: function(shared, task), tasks)

    def crew(self, shared: Any) -> AbstractContextManager[Crew[Any]]:
        """Return this process, and note the size of the object, which workers elsewhere would have to be sent."""
        self.calls.append(
            Call(stage(sys._getframe(1)), is_distributed=False, shared=self._size(shared))
        )
        return super().crew(shared)

    def _run(
        self, call: Call, function: Callable[[Any], Any], tasks: Iterable[Any]
    ) -> Iterator[Any]:
        self.calls.append(call)
        for task in tasks:
            start = time.process_time()
            result = function(task)
            call.seconds.append(time.process_time() - start)
            if call.is_distributed:
                call.results += self._size(result)
            yield result

    def _size(self, content: object) -> int:
        start = time.process_time()
        size = sys.getsizeof(Parcel.packed(content))
        self.overhead += time.process_time() - start
        return size

    def __reduce__(self) -> tuple[Any, ...]:
        return uvshear.Serial, ()


def main() -> None:
    """Measure with one worker, or read what was measured; simulate, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--field-arcmin", type=float, default=60.0)
    parser.add_argument("--integration-s", type=float, default=60.0)
    parser.add_argument("--calls", type=Path, help="JSON file of the tasks: read, or else written")
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    arguments = parser.parse_args()
    if arguments.calls is not None and arguments.calls.exists():
        found = json.loads(arguments.calls.read_text(encoding="utf-8"))
        calls, rest, galaxies = [Call(**each) for each in found[0]], found[1], found[2]
    else:
        calls, rest, galaxies = measured(arguments.field_arcmin, arguments.integration_s)
        if arguments.calls is not None:
            content = json.dumps([[asdict(call) for call in calls], rest, galaxies])
            arguments.calls.write_text(content, encoding="utf-8")
    figures = predicted(calls, rest)
    for name, value in figures.items():
        print(f"{name}: {value:.4g}")
    if arguments.record:
        title = (
            f"Tasks and bytes of a measurement of {galaxies} galaxies with one worker, and the simulated time on a"
            f" cluster; {BANDWIDTH / 1e9:g} GB/s between machines, {CORES_OF_A_MACHINE} cores in each."
        )
        write_record(RESULTS / f"{arguments.record}.json", figures, [7], title=title)


def measured(field_arcmin: float, integration_s: float) -> tuple[list[Call], float, int]:
    """Return the calls, the time outside tasks [s], and the number of galaxies."""
    galaxies, observation, _ = survey.simulate(field_arcmin, 2.8, integration_s, 7, in_copies())
    catalogue = catalogue_from_galaxies(galaxies, survey.PHASE_CENTRE)
    executor = Measured()
    start = time.process_time()
    uvshear.measure(observation, catalogue, resources=uvshear.Resources(executor=executor))
    spent = time.process_time() - start - executor.overhead
    in_tasks = sum(sum(call.seconds) for call in executor.calls)
    return executor.calls, spent - in_tasks, len(galaxies)


def predicted(calls: Sequence[Call], rest: float) -> dict[str, float]:
    """Return the simulated times [s] and efficiencies [%] for each number of workers."""
    alone = rest + sum(sum(call.seconds) for call in calls)
    figures = {
        "alone_s": alone,
        "serial_s": rest,
        "posteriors_shared_mb": max(
            (call.shared for call in calls if call.is_distributed), default=0
        )
        / 1e6,
        "sky_mb": max((call.shared for call in calls if not call.is_distributed), default=0) / 1e6,
    }
    for workers in WORKERS:
        spans = _spans(calls, workers, everywhere=False)
        total = rest + sum(spans.values())
        for name, span in sorted(spans.items()):
            figures[f"{name.replace(' ', '_')}_{workers}_s"] = span
        figures[f"all_{workers}_s"] = total
        figures[f"efficiency_{workers}_percent"] = 100 * alone / (workers * total)
        moved = rest + sum(_spans(calls, workers, everywhere=True).values())
        figures[f"everywhere_{workers}_s"] = moved
        figures[f"everywhere_efficiency_{workers}_percent"] = 100 * alone / (workers * moved)
        rounds = math.ceil(POINTINGS / workers)
        figures[f"pointings_{workers}_h"] = rounds * alone / 3600
        figures[f"pointings_efficiency_{workers}_percent"] = 100 * POINTINGS / (workers * rounds)
    # What stays when the tasks themselves take no time.
    longest = sum(max(call.seconds, default=0.0) for call in calls)
    return figures | {"longest_tasks_s": longest}


def _spans(calls: Sequence[Call], workers: int, *, everywhere: bool) -> dict[str, float]:
    """Return the duration of each stage [s]."""
    spans: dict[str, float] = defaultdict(float)
    for call in calls:
        if call.is_distributed or everywhere:
            spans[call.stage] += on_cluster(call, workers)
        else:
            spans[call.stage] += on_machine(call.seconds, min(workers, CORES_OF_A_MACHINE))
    return spans


def on_machine(seconds: Sequence[float], cores: int) -> float:
    """Return when the last task ends [s], if each task goes to the first core that is free."""
    free = [0.0] * cores
    for each in seconds:
        heapq.heapreplace(free, free[0] + each)
    return max(free)


def on_cluster(call: Call, workers: int) -> float:
    """Return when the last result is there [s].

    The shared object is sent to one worker, and from workers to others, whose number doubles each time. The scheduler
    hands out one batch after the other, and the client takes one result after the other.
    """
    machines = max(1, workers // CORES_OF_A_MACHINE)
    hops = 1 + math.ceil(math.log2(machines)) if call.shared else 0
    # Workers of one machine are sent the object one by one, over its memory.
    local = min(workers, CORES_OF_A_MACHINE) - 1 if call.shared else 0
    start = LATENCY + call.shared * (hops / BANDWIDTH + local / (10 * BANDWIDTH))
    free, told = [start] * workers, start
    for seconds in _batches(call.seconds, workers):
        told += BATCH
        heapq.heapreplace(free, max(free[0], told) + LATENCY / 2 + seconds)
    return max(*free, start + call.results / BANDWIDTH)


def _batches(seconds: Sequence[float], workers: int) -> Iterator[float]:
    """Yield the duration of each batch, whose size is chosen as ``dask_calls`` does."""
    left = len(seconds)
    while left:
        first = len(seconds) - left
        known = seconds[max(0, first - 1)]
        size = max(1, min(int(WORTH_A_BATCH / max(known, 1e-6)), left // (4 * workers)))
        yield sum(seconds[first : first + size])
        left -= size


if __name__ == "__main__":
    main()
