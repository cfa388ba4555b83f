"""The work that an extraction is expected to take, for reports of its progress."""

from dataclasses import dataclass

from uvshear.extraction.converged.beams import NANOSECONDS
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.extraction.converged.planner import Planner
from uvshear.extraction.converged.tile_sizes import work_of

FIT = 4e6
"""Cost of a fit [nanoseconds]."""

POSTERIOR = 12e6
"""Cost of a posterior [nanoseconds]."""

STATISTICS = 20e6
"""Cost of the statistics of a source [nanoseconds]."""


@dataclass(frozen=True)
class Workload:
    """Estimates of work [nanoseconds].

    Parameters
    ----------
    planner
        Plans the major cycles.
    rough_cycles
        Number of major cycles without the longest baselines.
    keeps_statistics
        Whether statistics are computed for every galaxy.
    """

    planner: Planner
    rough_cycles: int
    keeps_statistics: bool

    def foreseen(self, number: int, plan: MajorCyclePlan) -> float:
        """Return the work that becomes expected with the major cycle of this number, counted from 0.

        Before the first cycle, the rough cycles and one with all baselines are expected; each later cycle is added when
        it begins.
        """
        if number == 0:
            return self._taken_for_granted(plan)
        return self._cycle(plan) if number > self.rough_cycles else 0.0

    def _taken_for_granted(self, first: MajorCyclePlan) -> float:
        modelled = self.planner.modelled
        whole = self.planner.plan(modelled.expected)
        nodes = len(self.planner.plan_beams().nodes)
        galaxies = len(modelled.galaxies)
        work: float = NANOSECONDS * modelled.field.summary.samples * nodes
        work += self.rough_cycles * self._cycle(first) + self._cycle(whole)
        work += galaxies * POSTERIOR
        if self.keeps_statistics:
            work += galaxies * (FIT + STATISTICS)
        return work

    def _cycle(self, plan: MajorCyclePlan) -> float:
        modelled = self.planner.modelled
        samples = modelled.field.summary.samples // len(plan.bands)
        tiles = [tile for band in plan.tiles[plan.top :] for tile in band]
        return sum(work_of(samples, tile) for tile in tiles) + len(modelled.sources) * FIT
