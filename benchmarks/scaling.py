"""Estimate how long the square degree would take on 1 to 64 cores, from a run with one worker.

    python benchmarks/scaling.py --record scaling
    python benchmarks/scaling.py --field-arcmin 12 --integration-s 900

The duration of every task is recorded. The tasks of one call of an executor are then assigned in order, each to the
first worker that is free. Work outside tasks is done by one core. Memory bandwidth, messages between processes and the
making of copies are neglected.
"""

import argparse
import heapq
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

import survey
from record import RESULTS, write_record

import uvshear
from uvshear.execution import Executor, in_copies
from uvshear.io.catalogue import catalogue_from_galaxies

WORKERS = (1, 2, 4, 16, 64)

STAGES = {
    "first_major_cycle": "major cycles",
    "next_major_cycle": "major cycles",
    "run_minor_cycle": "minor cycles",
    "measure_shapes": "posteriors",
}
"""Functions within which a task belongs to a stage; all other tasks are of the stage ``other``."""


@dataclass
class Recorded(Executor):
    """Runs one task after the other, and notes how long each takes."""

    calls: list[tuple[str, list[float]]] = field(default_factory=list)

    @property
    def workers(self) -> int:
        """One."""
        return 1

    def at_most(self, workers: int) -> "Recorded":
        """Return this executor."""
        return self

    def map(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Iterator[Any]:
        """Yield the results, each computed when it is asked for."""
        seconds: list[float] = []
        self.calls.append((stage(sys._getframe(1)), seconds))

        def timed(task: object) -> object:
            start = time.perf_counter()
            result = function(task)
            seconds.append(time.perf_counter() - start)
            return result

        return map(timed, tasks)

    def distribute(
        self, function: Callable[[Any, Any], Any], shared: object, tasks: Iterable[Any]
    ) -> Iterator[Any]:
        """Yield the results, each computed when it is asked for."""
        return self.map(lambda task: function(shared, task), tasks)


def main() -> None:
    """Measure with one worker, and estimate the time with more from the durations of the tasks."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--field-arcmin", type=float, default=60.0)
    parser.add_argument("--integration-s", type=float, default=60.0)
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    arguments = parser.parse_args()
    galaxies, observation, _ = survey.simulate(
        arguments.field_arcmin, 2.8, arguments.integration_s, 7, in_copies()
    )
    catalogue = catalogue_from_galaxies(galaxies, survey.PHASE_CENTRE)
    executor = Recorded()
    start = time.perf_counter()
    uvshear.measure(observation, catalogue, resources=uvshear.Resources(executor=executor))
    wall = time.perf_counter() - start
    figures = predicted(executor.calls, wall)
    for name, value in figures.items():
        print(f"{name}: {value:.4g}")
    if arguments.record:
        title = f"Tasks of a measurement of {len(galaxies)} galaxies, and the estimated time with more workers."
        write_record(RESULTS / f"{arguments.record}.json", figures, [7], title=title)


def predicted(calls: list[tuple[str, list[float]]], wall: float) -> dict[str, float]:
    """Return the estimated time of each stage and of the whole run for each number of workers [s], and the speed-up."""
    in_tasks = sum(sum(seconds) for _, seconds in calls)
    rest = wall - in_tasks
    figures = {"wall_s": wall, "serial_s": rest, "serial_percent": 100 * rest / wall}
    for workers in WORKERS:
        spans: dict[str, float] = defaultdict(float)
        for name, seconds in calls:
            spans[name] += makespan(seconds, workers)
        total = rest + sum(spans.values())
        for name, span in sorted(spans.items()):
            figures[f"{name.replace(' ', '_')}_{workers}_s"] = span
        figures[f"all_{workers}_s"] = total
        figures[f"speed_{workers}"] = wall / total
    return figures


def makespan(seconds: Iterable[float], workers: int) -> float:
    """Return the time at which the last task ends [s], if each task goes to the first worker that is free."""
    free = [0.0] * workers
    for each in seconds:
        heapq.heapreplace(free, free[0] + each)
    return max(free)


def stage(frame: FrameType | None) -> str:
    """Return the stage to which a call belongs."""
    while frame is not None:
        if (name := STAGES.get(frame.f_code.co_name)) is not None:
            return name
        frame = frame.f_back
    return "other"


if __name__ == "__main__":
    main()
