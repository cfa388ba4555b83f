"""The number of major cycles that are to come."""

import numpy as np
import pytest

from uvshear.extraction.converged.foresight import Foresight
from uvshear.extraction.converged.history import History

FORESIGHT = Foresight(tolerance=0.1, rough_cycles=2, most=15)


def history(*changes):
    """Return a history with these changes in each major cycle."""
    found = History()
    for change in changes:
        found = found.with_cycle(np.array([change]), ())
    return found


def needed(*changes):
    """Count the cycles that come if changes go on to shrink as before."""
    count, last = 0, history(*changes)
    while count == 0 or last.left_undone >= FORESIGHT.tolerance:
        last = last.with_cycle(np.array([last.left_undone]), ())
        count += 1
    return count


def test_rough_cycles_and_a_whole_one_come_first():
    assert FORESIGHT.cycles_to_come(history()) == 3
    assert Foresight(0.1, 0, 15).cycles_to_come(history()) == 2
    assert Foresight(0.1, 0, 1).cycles_to_come(history()) == 1
    # It has converged, but the longest baselines are to come.
    assert FORESIGHT.cycles_to_come(history(1.0, 1e-3)) == 1


@pytest.mark.parametrize("changes", [(99.0, 9.0, 3.0, 1.0), (50.0, 9.0, 6.3), (9.0, 5.0, 0.5)])
def test_changes_go_on_to_shrink_as_they_did(changes):
    assert FORESIGHT.cycles_to_come(history(*changes)) == needed(*changes)


def test_the_first_change_shrinks_faster_than_later_ones():
    # Then 1.28 is left undone, and 0.41, 0.13 and 0.04 after three more.
    assert FORESIGHT.cycles_to_come(history(20.0, 4.0)) == 3
    # Measured with SKA-Mid (8 h), with SKA-Mid (6 min) and with the VLA (A): three, four and three cycles.
    assert FORESIGHT.cycles_to_come(history(11.7, 0.83)) == 1
    assert FORESIGHT.cycles_to_come(history(11.9, 2.34)) == 2
    assert FORESIGHT.cycles_to_come(history(16.9, 1.96)) == 1
    assert FORESIGHT.cycles_to_come(history(11.7)) == 2


def test_sources_that_do_not_come_to_rest_take_longer():
    moves = ((6.0, 18.0), (11.0, 13.0), (6.0, 17.0), (9.0, 14.0))
    # Measured with MeerKAT: nine cycles.
    restless = history(12.98).with_cycle(np.array([1.41]), moves)
    assert FORESIGHT.cycles_to_come(restless) == 7
    assert FORESIGHT.cycles_to_come(history(12.98, 1.41)) == 1


def test_a_jump_of_a_few_sources_does_not_go_on():
    # Measured with MeerKAT: one more cycle, with a change of 0.09.
    assert FORESIGHT.cycles_to_come(history(13.0, 1.41, 0.84, 0.61, 0.39, 0.31, 0.23, 0.83)) == 1
    # Two more were needed as well before it, when changes shrank by 0.76.
    assert FORESIGHT.cycles_to_come(history(13.0, 1.41, 0.84, 0.61, 0.39, 0.31, 0.23)) == 2


def test_no_more_cycles_are_foreseen_than_are_done():
    assert FORESIGHT.cycles_to_come(history(9.0, 10.0)) == 13
    assert Foresight(0.1, 2, 3).cycles_to_come(history(9.0, 8.9)) == 1
    assert Foresight(0.1, 2, 3).cycles_to_come(history(9.0, 8.9, 8.8)) == 1


def test_a_sky_that_did_not_change_needs_no_more_than_the_least():
    assert FORESIGHT.cycles_to_come(history(0.0, 0.0)) == 1
