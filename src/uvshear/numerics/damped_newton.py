r"""Maximisation by Gauss-Newton steps that are damped until they gain (Levenberg-Marquardt).

With g the gradient of the function and F an approximation to minus its second derivatives, a step solves

.. math:: (F + \lambda\, \mathrm{diag} F)\, \delta = g .

The damping lambda falls tenfold after a step that gains and grows tenfold after one that does not.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from typing import Generic, TypeVar

Point = TypeVar("Point")
Step = TypeVar("Step")


class Ascent(ABC, Generic[Point, Step]):
    """A function to climb, and the steps that lead from point to point."""

    @abstractmethod
    def step(self, point: Point, damping: float) -> tuple[Step, float] | None:
        """Return the damped step from a point and the product g . delta; None where no step leads on."""

    @abstractmethod
    def trial(self, point: Point, step: Step) -> Point | None:
        """Return the point that a step leads to; None where it is not a valid one."""

    @abstractmethod
    def height(self, point: Point) -> float:
        """Return the value of the function."""


@dataclass(frozen=True)
class Schedule:
    """Criteria for the damping of the steps and for the end of a climb.

    Parameters
    ----------
    tolerance
        Gain below which the climb has converged.
    most_steps
        Largest number of steps, including those that gain nothing.
    first
        Damping of the first step.
    least, most
        Limits of the damping; beyond the largest the climb is given up.
    short
        Damping above which the maximum counts as reached when a trial changes the function by less than the tolerance,
        even if it does not gain: such a step cannot achieve the gain that it predicts.
    """

    tolerance: float
    most_steps: int
    first: float
    least: float
    most: float
    short: float


class Ending(Enum):
    """Why a climb ended; the value is the sentence."""

    CONVERGED = "a further step would gain less than the tolerance"
    NO_STEP = "no step leads on from the point reached"
    NO_GAIN = "no step gains, however short"
    TOO_MANY_STEPS = "the maximum was not reached within the number of steps"


@dataclass(frozen=True)
class Summit(Generic[Point]):
    """The highest point found, and why the climb ended there."""

    point: Point
    ending: Ending


def climb(ascent: Ascent[Point, Step], start: Point, schedule: Schedule) -> Summit[Point]:
    """Climb from ``start`` until a step gains less than the tolerance; the function never falls."""
    point, height, damping = start, ascent.height(start), schedule.first
    for _ in range(schedule.most_steps):
        proposal = ascent.step(point, damping)
        if proposal is None:
            return Summit(point, Ending.NO_STEP)
        step, promised = proposal
        if promised < schedule.tolerance:
            return Summit(point, Ending.CONVERGED)
        trial = ascent.trial(point, step)
        gain = -math.inf if trial is None else ascent.height(trial) - height
        if trial is not None and gain > 0:
            point, height, damping = trial, height + gain, max(damping / 10, schedule.least)
        else:
            damping *= 10
        if abs(gain) < schedule.tolerance and (gain > 0 or damping > schedule.short):
            return Summit(point, Ending.CONVERGED)
        if damping > schedule.most:
            return Summit(point, Ending.NO_GAIN)
    return Summit(point, Ending.TOO_MANY_STEPS)
