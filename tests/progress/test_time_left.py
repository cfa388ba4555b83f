"""The time that a computation still needs: in closed form, and on recorded runs (benchmarks/progress_recordings.py)."""

import pytest

from uvshear.progress import Stage
from uvshear.progress.time_left import Finished, Running, pace, time_left


def running(stage, done, seconds):
    """Return a stage that began at time 0, with its last report after some seconds."""
    return Running(stage, 0.0, done, stage.amount, seconds)


def test_the_pace_is_time_over_work():
    assert pace([Finished("a", 4.0, 2.0), Finished("b", 4.0, 6.0)]) == 1.0
    assert pace([Finished("preparation", 0.0, 9.0)]) is None


def test_nothing_is_known_of_the_time_of_work_of_unknown_size():
    assert time_left([Finished("a", 1.0, 1.0)], running(Stage("b"), 1.0, 1.0), (), 1.0) is None


def test_the_first_stage_goes_on_as_it_began():
    left = time_left([], running(Stage("a", 10.0, 5.0), 2.0, 8.0), (Stage("b", 5.0),), 8.0)
    assert left == pytest.approx(12.0 + 10.0)


def test_a_kind_that_was_seen_keeps_its_pace():
    seen = [Finished("a", 1.0, 3.0), Finished("b", 1.0, 1.0)]
    then = (Stage("x", 2.0, kind="b"), Stage("y", 2.0, kind="a"))
    left = time_left(seen, running(Stage("z", 1.0, 1.0, kind="b"), 0.0, 0.0), then, 0.0)
    assert left == pytest.approx(1.0 + 2.0 + 6.0)


def test_a_kind_that_was_not_seen_takes_the_pace_of_all_work():
    seen = [Finished("a", 1.0, 3.0), Finished("b", 1.0, 1.0)]
    left = time_left(seen, running(Stage("c", 1.0, 1.0), 0.0, 0.0), (Stage("d", 1.0),), 0.0)
    assert left == pytest.approx(2.0 + 2.0)


def test_a_stage_shows_its_own_pace_more_and_more():
    stage = Stage("a", 1.0, 100.0)
    # It takes three times as long as all work before.
    left = [
        time_left([Finished("b", 1.0, 1.0)], running(stage, done, 0.03 * done), (), 0.03 * done)
        for done in (1.0, 50.0, 100.0)
    ]
    truth = [3 * (1 - done / 100) for done in (1.0, 50.0, 100.0)]
    assert left[0] < 0.6 * truth[0]
    assert left[1] > 0.7 * truth[1]
    assert left[2] == 0


def test_a_stage_that_is_overdue_has_some_time_left():
    stage = running(Stage("a", 10.0, 10.0), 5.0, 10.0)
    assert [time_left([], stage, (), now) for now in (10.0, 14.0, 100.0)] == [10.0, 6.0, 1.0]
