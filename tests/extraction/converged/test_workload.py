"""The stages that are foreseen."""

import numpy as np
import pytest

from tests.extraction.converged.states import touching_pair
from uvshear.estimators import Moments
from uvshear.extraction.converged.foresight import Foresight
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.workload import STATISTICS, Workload


class OfOneself:
    """A statistic that does not state its cost."""

    @property
    def columns(self):
        return {}

    def statistic(self, source):
        return None


@pytest.fixture(scope="module")
def planner():
    return touching_pair().planner


@pytest.fixture(scope="module")
def plan(planner):
    return planner.plan(planner.modelled.expected)


def workload(planner, rough_cycles=2, keep=()):
    return Workload(planner, Foresight(0.1, rough_cycles, 15), keep, 1e-4)


def names(stages):
    return [stage.name for stage in stages]


def test_rough_cycles_and_a_whole_one_are_taken_for_granted(planner, plan):
    stages = workload(planner).stages(History(), plan)
    cycles = [f"{kind} cycle {number}" for number in (1, 2, 3) for kind in ("major", "minor")]
    assert names(stages) == [*cycles, "posteriors"]
    assert names(workload(planner, 0).stages(History(), plan)) == [*cycles[:2], "posteriors"]
    assert all(stage.cost > 0 for stage in stages)


def test_as_many_cycles_are_foreseen_as_it_takes_to_converge(planner, plan):
    history = History()
    for change in (8.0, 4.0, 2.0):
        history = history.with_cycle(np.array([change]), ((change, 0.1),))
    stages = workload(planner).stages(history, plan)
    # 1, 0.5, 0.25, 0.125, and 0.0625 is left undone.
    assert names(stages)[:2] == ["major cycle 4", "minor cycle 4"]
    assert names(stages)[-2:] == ["minor cycle 7", "posteriors"]


def test_the_first_major_cycle_makes_the_beams_as_well(planner, plan):
    known = workload(planner)
    first, second, third = (
        stage for stage in known.stages(History(), plan) if stage.name.startswith("major")
    )
    assert second.cost == third.cost < first.cost
    assert 1 - known.share_of_beams == pytest.approx(second.cost / first.cost)


def test_visibilities_of_the_used_baselines_are_counted(planner, plan):
    (first, *_) = workload(planner).stages(History(), plan)
    samples = planner.modelled.field.summary.samples
    assert first.unit == "visibilities"
    assert 0.5 * samples < first.amount <= samples


def test_statistics_are_stages_too(planner):
    assert names(workload(planner).ending) == ["posteriors"]
    ending = workload(planner, keep=(Moments(), OfOneself())).ending
    assert names(ending) == ["posteriors", "wide prior", "statistics"]
    assert ending[-1].cost == 2 * (Moments.nanoseconds + STATISTICS)
    assert ending[-1].amount == 2
