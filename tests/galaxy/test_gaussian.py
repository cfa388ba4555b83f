from dataclasses import FrozenInstanceError

import galsim
import pytest

from tests.galaxy.profile_battery import (
    EXACT,
    check_any_shape,
    check_galsim,
    check_lensing,
    check_profile,
)
from uvshear.galaxy import Gaussian


def _round(radius):
    return galsim.Gaussian(sigma=radius, gsparams=EXACT)


def test_it_passes_the_battery():
    check_profile(Gaussian())


def test_galsim_has_the_same_transform():
    check_galsim(Gaussian(), _round)


def test_it_is_lensed_as_galsim_lenses():
    check_lensing(Gaussian(), _round)


def test_arrays_of_any_shape_keep_it():
    check_any_shape(Gaussian())


def test_it_is_immutable():
    with pytest.raises(FrozenInstanceError):
        Gaussian().scale = 1.0
