"""Climbing two functions of two variables: a curved valley, and a cliff."""

import math

import numpy as np
import pytest

from uvshear.numerics.damped_newton import Ascent, Ending, Schedule, climb

SCHEDULE = Schedule(tolerance=1e-12, most_steps=200, first=1e-3, least=0.0, most=1e6, short=1.0)


class Rosenbrock(Ascent):
    """The negative of Rosenbrock's function, whose maximum is at (1, 1)."""

    def __init__(self):
        self.heights = []

    def _residual(self, point):
        return np.array([10 * (point[1] - point[0] ** 2), 1 - point[0]])

    def step(self, point, damping):
        jacobian = np.array([[-20 * point[0], 10.0], [-1.0, 0.0]])
        information = jacobian.T @ jacobian
        gradient = -jacobian.T @ self._residual(point)
        damped = information + damping * np.diag(np.diag(information))
        step = np.linalg.solve(damped, gradient)
        return step, float(gradient @ step)

    def trial(self, point, step):
        return point + step

    def height(self, point):
        self.heights.append(-0.5 * float(np.sum(self._residual(point) ** 2)))
        return self.heights[-1]


def test_the_end_of_a_curved_valley_is_found():
    summit = climb(Rosenbrock(), np.array([-1.2, 1.0]), SCHEDULE)
    assert summit.ending is Ending.CONVERGED
    np.testing.assert_allclose(summit.point, [1.0, 1.0], rtol=0, atol=1e-6)


def test_the_function_never_falls_although_trials_do():
    ascent = Rosenbrock()
    reached = []

    def watched(point, step):
        reached.append(-0.5 * float(np.sum(ascent._residual(point) ** 2)))
        return point + step

    ascent.trial = watched
    climb(ascent, np.array([-1.2, 1.0]), SCHEDULE)
    assert np.all(np.diff(reached) >= 0)
    assert np.any(np.diff(ascent.heights) < 0)


def test_too_few_steps_are_told():
    few = Schedule(tolerance=1e-12, most_steps=2, first=1e-3, least=0.0, most=1e6, short=1.0)
    assert climb(Rosenbrock(), np.array([-1.2, 1.0]), few).ending is Ending.TOO_MANY_STEPS


class Line(Rosenbrock):
    """A slope whose every trial is refused, or that offers no step."""

    def __init__(self, *, offers=True, gain=None):
        self.offers, self.gain, self.dampings = offers, gain, []

    def step(self, point, damping):
        self.dampings.append(damping)
        return (1.0, 1.0) if self.offers else None

    def trial(self, point, step):
        return None if self.gain is None else point + self.gain

    def height(self, point):
        return float(point)


def test_where_no_step_leads_on_the_climb_ends():
    summit = climb(Line(offers=False), 0.0, SCHEDULE)
    assert (summit.ending, summit.point) == (Ending.NO_STEP, 0.0)


def test_invalid_points_are_refused_with_more_damping_until_it_is_given_up():
    line = Line()
    summit = climb(line, 0.0, SCHEDULE)
    assert (summit.ending, summit.point) == (Ending.NO_GAIN, 0.0)
    np.testing.assert_allclose(line.dampings, 10.0 ** np.arange(-3, 7))


@pytest.mark.parametrize(("short", "ending"), [(1.0, Ending.CONVERGED), (math.inf, Ending.NO_GAIN)])
def test_a_short_step_that_neither_gains_nor_loses_was_at_the_top(short, ending):
    schedule = Schedule(
        tolerance=1e-3, most_steps=80, first=1e-3, least=1e-3, most=1e6, short=short
    )
    assert climb(Line(gain=-1e-4), 0.0, schedule).ending is ending


def test_the_damping_falls_to_its_least():
    schedule = Schedule(tolerance=1e-3, most_steps=5, first=1.0, least=0.05, most=1e6, short=1.0)
    line = Line(gain=1.0)
    climb(line, 0.0, schedule)
    assert line.dampings == [1.0, 0.1, 0.05, 0.05, 0.05]
