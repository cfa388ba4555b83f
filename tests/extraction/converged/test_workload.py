"""The stages that are foreseen."""

import numpy as np
import pytest

from tests.extraction.converged.states import touching_pair
from uvshear.estimators import Moments
from uvshear.extraction.converged.foresight import Foresight
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.minor_cycle import MOST_ITERATIONS
from uvshear.extraction.converged.plan import MajorCyclePlan
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


@pytest.fixture
def _rough(monkeypatch):
    """Plans that leave out the longest baselines."""
    monkeypatch.setattr(MajorCyclePlan, "has_all_baselines", False)


@pytest.mark.usefixtures("_rough")
def test_rough_cycles_and_a_whole_one_are_taken_for_granted(planner, plan):
    stages = workload(planner).stages(History(), plan)
    cycles = [f"{kind} cycle {number}" for number in (1, 2, 3) for kind in ("major", "minor")]
    assert names(stages) == [*cycles, "posteriors"]
    assert names(workload(planner, 0).stages(History(), plan)) == [*cycles[:4], "posteriors"]
    assert all(stage.cost > 0 for stage in stages)


def test_where_no_baseline_is_left_out_no_cycle_is_taken_for_granted(planner, plan):
    """Measured with MeerKAT, 200 galaxies in 20 arcmin: two cycles, with changes of 12.3 and 0.74."""
    known, moves = workload(planner), ((9.0, 1.0),)
    assert names(known.stages(History(), plan))[-3:] == [
        "major cycle 2",
        "minor cycle 2",
        "posteriors",
    ]
    history = History().with_cycle(np.array([12.3]), moves)
    assert names(known.stages(history, plan))[0] == "major cycle 2"
    converged = history.with_cycle(np.array([0.09]), moves)
    assert names(known.stages(converged, plan))[-2:] == ["minor cycle 3", "posteriors"]


def test_as_many_cycles_are_foreseen_as_it_takes_to_converge(planner, plan):
    history = History()
    for change in (8.0, 4.0, 2.0):
        history = history.with_cycle(np.array([change]), ((change, 0.1),))
    stages = workload(planner).stages(history, plan)
    # 1, 0.5, 0.25, 0.125, and 0.0625 is left undone.
    assert names(stages)[:2] == ["major cycle 4", "minor cycle 4"]
    assert names(stages)[-2:] == ["minor cycle 7", "posteriors"]


def test_sources_that_do_not_come_to_rest_are_fitted_more_often(planner, plan):
    rests, restless = (
        History().with_cycle(np.array([13.0]), moves).with_cycle(np.array([1.4]), moves)
        for moves in (((9.0, 1.0),), ((9.0, 9.0),) * MOST_ITERATIONS)
    )
    (_, short, *_), (_, long, *more) = (
        workload(planner).stages(history, plan) for history in (rests, restless)
    )
    assert short.name == long.name == "minor cycle 3"
    assert long.amount > 1.5 * short.amount
    assert more[1].amount == long.amount


@pytest.mark.usefixtures("_rough")
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
