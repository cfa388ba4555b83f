"""Reports of a computation about its progress."""

from tests.progress.heard import Heard
from uvshear.progress import Meter, Stage


def told():
    """Return a list, and a function that appends what it is told to it."""
    heard = []
    return heard, lambda done, total: heard.append((done, total))


def test_without_stages_units_are_counted():
    heard, progress = told()
    meter = Meter(progress)
    meter.expect(3)
    meter.add()
    meter.add(2)
    assert heard == [(1, 3), (3, 3)]


def test_a_function_is_told_of_the_work_of_all_stages():
    heard, progress = told()
    meter = Meter(progress)
    second = Stage("second", 40.0, 1.0)
    meter.begin(Stage("first", 60.0, 3.0), second)
    meter.add()
    meter.add(2)
    meter.begin(second)
    meter.add(0.5)
    meter.finish()
    assert heard == [(20, 100), (60, 100), (80, 100), (80, 80)]


def test_a_stage_may_be_longer_than_expected():
    heard, progress = told()
    meter = Meter(progress)
    meter.begin(Stage("first", 10.0, 1.0))
    meter.add(3)
    meter.expect(3)
    meter.add()
    assert heard == [(30, 30), (40, 40)]


def test_what_follows_may_turn_out_to_be_longer():
    heard, progress = told()
    meter = Meter(progress)
    meter.begin(Stage("first", 60.0, 3.0), Stage("second", 40.0))
    meter.add()
    meter.foresee(Stage("second", 70.0), Stage("third", 10.0))
    meter.add()
    assert heard == [(20, 100), (40, 140)]


def test_an_observer_is_told_of_stages_and_of_their_units():
    heard = Heard()
    meter = Meter(heard)
    meter.begin(Stage("first", 60.0, 3.0), Stage("second", 40.0, 1.0))
    meter.add()
    meter.expect(1)
    meter.add()
    meter.note(rms=0.1)
    meter.finish()
    assert heard.all == [
        ("begin", "first", ("second",)),
        ("advance", 1.0, 3.0),
        ("advance", 2.0, 4.0),
        ("note", {"rms": 0.1}),
        ("advance", 2.0, 2.0),
        ("finish",),
    ]


def test_a_computation_may_be_a_stage_of_another():
    heard = Heard()
    meter = Meter(heard)
    meter.begin(Stage("field 1 of 2", 1.0, 1.0))
    inner = Meter(meter.reach)
    inner.expect(4)
    inner.add()
    inner.add()
    # The total has grown: what was reported stays.
    inner.expect(12)
    inner.add()
    assert [what[1] for what in heard.all[1:]] == [0.25, 0.5, 0.5]


def test_only_an_observer_hears_of_stages_before_the_work_can_be_told():
    heard, progress = told()
    for listener in (progress, Heard()):
        meter = Meter.of_stages(listener)
        meter.begin(Stage("first pass"))
        meter.add(5)
    assert heard == []
    assert listener.stages == ["first pass"]


def test_nobody_needs_to_listen():
    meter = Meter(None)
    meter.begin(Stage("first", 1.0, 1.0))
    meter.add()
    meter.note(rms=1.0)
    meter.finish()
