"""The course of a computation, on a clock of the test."""

import pytest

from uvshear.progress import Course, Meter, Stage


class Clock:
    """A clock that stands still unless it is moved."""

    def __init__(self):
        self.time = 100.0

    def __call__(self):
        return self.time


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def course(clock):
    return Course(clock)


def test_nothing_is_known_before_the_first_report(course, clock):
    clock.time += 5.0
    assert (course.elapsed, course.left, course.share, course.rate) == (5.0, None, 0.0, None)
    assert (course.stage, course.unit) == ("", "")


def test_the_stage_and_its_rate_are_known(course, clock):
    meter = Meter(course)
    meter.begin(Stage("first", 1e9, 10.0, "fits"))
    clock.time += 4.0
    meter.add(2)
    assert (course.stage, course.unit, course.rate) == ("first", "fits", 0.5)
    meter.begin(Stage("second", 1e9, 10.0))
    assert (course.stage, course.unit, course.rate) == ("second", "", None)


def test_time_goes_on_between_reports(course, clock):
    meter = Meter(course)
    meter.begin(Stage("first", 1e9, 10.0))
    for _ in range(2):
        clock.time += 2.0
        meter.add()
    assert course.left == pytest.approx(16.0)
    clock.time += 3.0
    assert course.left == pytest.approx(13.0)
    assert course.share == pytest.approx(7 / 20)


def test_other_stages_may_be_foreseen(course, clock):
    meter = Meter(course)
    meter.begin(Stage("first", 10e9, 10.0), Stage("second", 10e9))
    for _ in range(5):
        clock.time += 1.0
        meter.add()
    assert course.left == pytest.approx(15.0)
    meter.foresee(Stage("second", 30e9))
    assert course.left == pytest.approx(35.0)


def test_what_was_done_lately_tells_the_pace(course, clock):
    meter = Meter(course)
    meter.begin(Stage("first", 1e9, 100.0))
    # The first unit takes long, and each of the others a second.
    clock.time += 60.0
    meter.add()
    assert course.left is None
    for done in range(2, 51):
        clock.time += 1.0
        meter.add()
        assert course.left == pytest.approx(100 - done)


def test_the_share_never_falls(course, clock):
    meter = Meter(course)
    meter.begin(Stage("first", 1e9, 10.0))
    for _ in range(2):
        clock.time += 1.0
        meter.add(2.5)
    before = course.share
    assert before == pytest.approx(0.5)
    meter.expect(100)
    meter.add(0.001)
    assert course.left > 20
    assert course.share == before


def test_work_without_stages_has_an_end_too(course, clock):
    for done in (1, 2):
        clock.time += 2.0
        course(done, 4)
    assert course.left == pytest.approx(4.0)
    assert course.stage == ""


def test_after_the_end_nothing_is_left(course, clock):
    meter = Meter(course)
    meter.begin(Stage("first", 1e9, 10.0))
    clock.time += 4.0
    meter.add(10)
    meter.finish()
    assert (course.stage, course.left) == ("", None)
