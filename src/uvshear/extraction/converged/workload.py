"""The stages of an extraction and the work that each is expected to take, for reports of its progress."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from uvshear.extraction.converged.beams import NANOSECONDS
from uvshear.extraction.converged.foresight import Foresight
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.extraction.converged.planner import Planner
from uvshear.extraction.converged.release import RELEASES
from uvshear.extraction.converged.tile_sizes import FEW_PROBES, tasks_of_bands
from uvshear.progress import Stage
from uvshear.shapes.source_facet import Statistic

MAJOR_CYCLE = 1.15
"""Time of a major cycle over the estimated cost of its images: samples are sorted, and sources drawn."""

DRAWN = 0.3e6
"""Cost of a source in a major cycle, in which it is drawn and cut out [nanoseconds]."""

FIT = 3.4e6
"""Cost of a fit in a minor cycle, with its share of all that comes between the fits [nanoseconds]."""

POSTERIOR, POSTERIOR_OF_CELL = 6e6, 1.2e3
"""Cost of a posterior, and of each cell of the facet besides [nanoseconds]."""

STATISTICS = 20e6
"""Cost of the statistics of a source for an estimator that does not state its cost [nanoseconds]."""

ROUGH_GAIN, GRIDDING_GAIN, FITTING_GAIN, SAMPLING_GAIN = 0.35, 0.6, 0.7, 0.8
"""Logarithm of the gain in speed by some workers, over that of their number: in rough and in whole major cycles, in
minor cycles, and in posteriors and statistics. Two workers measure a field of 12 arcmin with 403 galaxies 1.6 times as
fast as one; the rough cycles of a small field have few tasks."""

ITERATIONS = (2, 2, 1)
"""Usual numbers of iterations of the first minor cycles; later ones take as many as the last one did, and so does the
last of these after one in which the sources have not come to rest."""

FITTED, FITTED_AGAIN = 0.93, 0.25
"""Part of the sources that are fitted in an iteration, and in the second and later iterations of later cycles."""

RELEASED_FITS = 1.2
"""Number of fits of each source in each minor cycle of the released sky."""


@dataclass(frozen=True)
class Workload:
    """Stages of an extraction.

    Parameters
    ----------
    planner
        Plans the major cycles.
    foresight
        Foresees the number of major cycles.
    keep
        Statistics that are computed for every galaxy.
    epsilon
        Relative error of the gridder.
    workers
        Number of workers.
    """

    planner: Planner
    foresight: Foresight
    keep: tuple[Statistic, ...]
    epsilon: float
    workers: int = 1

    def stages(self, history: History, plan: MajorCyclePlan) -> tuple[Stage, ...]:
        """Return all stages that are expected from the next major cycle on, for which there is a plan."""
        # Where rough cycles leave no baselines out, the sky may converge in them.
        rough_cycles = 0 if self._rough.has_all_baselines else self.foresight.rough_cycles
        foresight = replace(self.foresight, rough_cycles=rough_cycles)
        first, count = len(history), foresight.cycles_to_come(history)
        cycles: list[Stage] = []
        for number in range(first, first + count):
            is_planned = number == first or number < rough_cycles
            of_plan = plan if is_planned else self._whole
            cycles += [self._major_cycle(number, of_plan), self._minor_cycle(number, history)]
        return (*cycles, *self.ending)

    @cached_property
    def ending(self) -> tuple[Stage, ...]:
        """Stages after the last cycle."""
        galaxies = len(self.planner.modelled.galaxies)
        cells = np.mean([len(cutout.multiplicity) for cutout in self._whole.cutouts])
        posterior = POSTERIOR + POSTERIOR_OF_CELL * float(cells)
        posteriors = self._stage("posteriors", galaxies, "galaxies", posterior, SAMPLING_GAIN)
        if not self.keep:
            return (posteriors,)
        each = sum(getattr(statistic, "nanoseconds", STATISTICS) for statistic in self.keep)
        statistics = self._stage("statistics", galaxies, "galaxies", each, SAMPLING_GAIN)
        fits = RELEASES * RELEASED_FITS * len(self.planner.modelled.sources)
        release = self._stage("wide prior", fits, "fits", FIT, FITTING_GAIN, "minor cycle")
        return posteriors, release, statistics

    @property
    def share_of_beams(self) -> float:
        """Share of the beams in the work of the first major cycle."""
        return self._beams / (self._beams + self._cost(self._rough))

    def _major_cycle(self, number: int, plan: MajorCyclePlan) -> Stage:
        cost = self._cost(plan) + (self._beams if number == 0 else 0.0)
        samples = self._samples(plan)
        return self._stage(
            f"major cycle {number + 1}",
            samples,
            "visibilities",
            cost / samples,
            GRIDDING_GAIN if plan.has_all_baselines else ROUGH_GAIN,
            "major cycle" if plan.has_all_baselines else "rough major cycle",
        )

    def _minor_cycle(self, number: int, history: History) -> Stage:
        part = ITERATIONS[min(number, len(ITERATIONS) - 1)] * FITTED
        is_late = number >= len(ITERATIONS) - 1
        if len(history) >= len(ITERATIONS) or (is_late and history.is_restless):
            part += FITTED_AGAIN * (len(history.moves[-1]) - 1)
        fits = part * len(self.planner.modelled.sources)
        name = f"minor cycle {number + 1}"
        return self._stage(name, fits, "fits", FIT, FITTING_GAIN, "minor cycle")

    def _stage(
        self, name: str, amount: float, unit: str, each: float, gain: float, kind: str = ""
    ) -> Stage:
        """Return a stage of which every unit takes some time on one core [ns], with its expected time."""
        return Stage(name, amount * each / self.workers**gain, amount, unit, kind, 1e-9)

    @cached_property
    def _rough(self) -> MajorCyclePlan:
        return self.planner.plan_roughly(self.planner.modelled.expected)

    @cached_property
    def _whole(self) -> MajorCyclePlan:
        return self.planner.plan(self.planner.modelled.expected)

    @cached_property
    def _beams(self) -> float:
        """Work of the beams [ns]."""
        nodes = len(self.planner.plan_beams().nodes)
        return NANOSECONDS * self._samples(self._whole) * nodes

    def _samples(self, plan: MajorCyclePlan) -> float:
        """Estimate the number of samples that a major cycle uses, by the probes."""
        summary = self.planner.modelled.field.summary
        distance = np.hypot(*summary.probes.uvw[:, :2].T)
        used = (distance >= plan.shortest) & (distance < plan.longest)
        return max(1.0, summary.samples * float(np.mean(used)))

    def _cost(self, plan: MajorCyclePlan) -> float:
        """Estimate the work of a major cycle [ns]."""
        modelled = self.planner.modelled
        summary, response = modelled.field.summary, modelled.response
        sources = modelled.field.sky.select(modelled.field.modelled)
        few = summary.probes.select(slice(FEW_PROBES))
        factors = None if response.is_common(sources) else response.factors(few, sources)
        tasks = tasks_of_bands(plan, factors, few.uvw.astype(float), summary.samples, self.epsilon)
        of_images = sum(map(sum, tasks[plan.top :]))
        return MAJOR_CYCLE * of_images + DRAWN * len(modelled.sources)
