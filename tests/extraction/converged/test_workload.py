"""The work that is foreseen."""

import pytest

from tests.extraction.converged.states import touching_pair
from uvshear.extraction.converged.workload import FIT, STATISTICS, Workload


@pytest.fixture(scope="module")
def planner():
    return touching_pair().planner


def test_rough_cycles_and_a_whole_one_are_taken_for_granted(planner):
    plan = planner.plan(planner.modelled.expected)
    workload = Workload(planner, 2, keeps_statistics=False)
    foreseen = [workload.foreseen(number, plan) for number in range(5)]
    assert foreseen[0] > 3 * foreseen[3] > 0
    assert foreseen[1:3] == [0, 0]
    assert foreseen[3] == foreseen[4]
    single = Workload(planner, 0, keeps_statistics=False)
    assert single.foreseen(1, plan) == foreseen[3]


def test_statistics_are_work_too(planner):
    plan = planner.plan(planner.modelled.expected)
    without, with_statistics = (
        Workload(planner, 2, keeps_statistics=keeps).foreseen(0, plan) for keeps in (False, True)
    )
    assert with_statistics - without == pytest.approx(2 * (FIT + STATISTICS))
