"""What 4, 16 and 64 cores would give for the square degree, from the times of all tasks of a run with one worker.

    python benchmarks/scaling.py --record scaling
    python benchmarks/scaling.py --field-arcmin 12 --integration-s 900

Tasks that an executor gets together are handed to workers in their order, each to the first that is free. What is not a
task is done by one core. The memory of a machine is assumed to serve any number of cores.
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
    """Measure with one worker, and hand the tasks to others on paper."""
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
        title = f"Tasks of a measurement of {len(galaxies)} galaxies, and the time that more workers would take."
        write_record(RESULTS / f"{arguments.record}.json", figures, [7], title=title)


def predicted(calls: list[tuple[str, list[float]]], wall: float) -> dict[str, float]:
    """Return the time of each stage with each number of workers, and in all."""
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
    """Return when the last of the tasks has ended, if each goes to the first worker that is free."""
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
