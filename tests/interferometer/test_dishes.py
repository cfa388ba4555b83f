"""Dishes of an observation, and of all of its parts."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from tests.interferometer.chunks import CENTRE, observation
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.dishes import dish_diameters, pointing_of
from uvshear.interferometer.joint_observation import JointObservation
from uvshear.interferometer.origin import Origin
from uvshear.interferometer.scaled_observation import ScaledObservation


@dataclass(frozen=True)
class Dishes:
    """An observation of dishes, in a file of this name."""

    name: str = "first"
    diameter: float = 13.5
    pointing: PhaseCentre = CENTRE
    phase_centre: PhaseCentre = CENTRE

    def chunks(self):
        return observation(1).chunks()

    def origin(self):
        return Origin(self, self.name)

    def dish_diameters(self):
        return np.array([self.diameter, 15.0])

    def pointing_direction(self):
        return self.pointing


NORTH = PhaseCentre(CENTRE.ra, CENTRE.dec + 0.01)
FIRST = Dishes()


def _joint(second):
    return JointObservation(CENTRE, (FIRST, second))


def test_dishes_are_those_of_the_origin():
    for seen in (FIRST, ScaledObservation(FIRST, 2.0), _joint(replace(FIRST, name="second"))):
        np.testing.assert_array_equal(dish_diameters(seen), [13.5, 15.0])
        assert pointing_of(seen) == (0.0, 0.0)


def test_the_pointing_is_about_the_phase_centre():
    assert pointing_of(Dishes(pointing=NORTH)) == pytest.approx((0.0, np.sin(0.01)))


def test_parts_need_the_same_dishes():
    with pytest.raises(InputError, match="second: its dishes differ from those of first"):
        dish_diameters(_joint(Dishes("second", diameter=12.0)))


def test_parts_need_the_same_pointing():
    near = PhaseCentre(CENTRE.ra, CENTRE.dec + 0.5 * ARCSEC)
    assert pointing_of(_joint(Dishes("second", pointing=near))) == (0.0, 0.0)
    with pytest.raises(
        InputError, match="second: its dishes pointed in another direction than those of first"
    ):
        pointing_of(_joint(Dishes("second", pointing=NORTH)))


def test_dishes_that_pointed_away_have_no_beam():
    away = PhaseCentre(CENTRE.ra + np.pi, -CENTRE.dec)
    with pytest.raises(InputError, match="first: the dishes pointed more than 90 degrees"):
        pointing_of(Dishes(pointing=away))


def test_an_observation_that_does_not_know_its_dishes_says_so():
    for ask in (dish_diameters, pointing_of):
        with pytest.raises(
            InputError, match="does not give the diameters and the pointing of the dishes"
        ):
            ask(observation(1))
