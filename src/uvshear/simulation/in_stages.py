"""A simulation in stages, which report their progress.

Blocks are predicted some at a time, and then they get their noise one by one, while those before them are used. The
time of both is estimated beforehand: a prediction tells it once it has been planned, and others take as long for each
of their visibilities.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from uvshear.execution import Executor
from uvshear.progress import Meter, Stage
from uvshear.simulation.observation import CorrelationBlock, SimulatedObservation

PLANNING, PLANNING_OF_GALAXY = 100.0, 30e3
"""Time of a baseline, and of a galaxy, in the plan of a prediction [ns]; the latter with eight octaves of baselines."""

ROW, SAMPLE, NOISE = 250.0, 30.0, 50.0
"""Time of a baseline and of each of its visibilities while they are written, and of the noise of a visibility [ns]."""

GAIN = 0.8
"""Logarithm of the gain in speed of a prediction by some workers, over that of their number."""


def blocks_in_stages(
    observation: SimulatedObservation, executor: Executor, meter: Meter
) -> Iterator[CorrelationBlock]:
    """Yield what ``observation.blocks`` does; report predictions, and the use of their blocks, which is called writing.

    The first prediction is planned before its stage begins.
    """
    parts = observation.row_ranges
    if not parts:
        return
    planned = observation.planned(parts[0], executor)
    work = _Work(observation, planned.cost, executor.workers)
    stages = [stage for number in range(len(parts)) for stage in work.stages(number)]
    for number, rows in enumerate(parts):
        meter.begin(*stages[2 * number :])
        planning = 0.0
        if number:
            planning = work.planning(rows)
            planned = observation.planned(rows, executor)
        sky = planned.visibilities(executor, partial(_report, meter, planning))
        meter.begin(*stages[2 * number + 1 :])
        for block in observation.blocks_of(rows.start, sky.astype(np.complex64), executor):
            yield block
            meter.add(len(block) * len(observation.channels))


def _report(meter: Meter, planning: float, done: int, total: int) -> None:
    """Report how much of a prediction is done, besides its plan."""
    meter.reach(round(planning) + done, round(planning) + total)


@dataclass(frozen=True)
class _Work:
    """The work of a simulation, given that of the first prediction without its plan [ns of one core]."""

    observation: SimulatedObservation
    first_cost: float
    workers: int

    def stages(self, number: int) -> tuple[Stage, Stage]:
        """Return the stages of some of the blocks."""
        parts, channels = self.observation.row_ranges, len(self.observation.channels)
        rows, of_all = parts[number], f" {number + 1} of {len(parts)}" if len(parts) > 1 else ""
        prediction = self.first_cost * len(rows) / len(parts[0])
        if number:
            prediction += self.planning(rows)
        prediction /= self.workers**GAIN
        noise = 0.0 if self.observation.seed is None else NOISE / self.workers
        writing = len(rows) * (ROW + channels * (SAMPLE + noise))

        def stage(kind: str, cost: float) -> Stage:
            samples = len(rows) * channels
            return Stage(kind + of_all, max(cost, 1.0), samples, "visibilities", kind)

        return stage("prediction", prediction), stage("writing", writing)

    def planning(self, rows: range) -> float:
        """Estimate the time of the plan of a prediction [ns]."""
        return len(rows) * PLANNING + len(self.observation.galaxies) * PLANNING_OF_GALAXY
