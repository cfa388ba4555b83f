"""The choice between images and the sum."""

import math

import numpy as np
import pytest

from tests.skies import galaxies
from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential, Sersic
from uvshear.imaging.bands import Band
from uvshear.predict.drawable import (
    LARGEST_STAMP,
    MOST_TILES,
    SMALLEST_STAMP,
    cheapest_side,
    relative_error,
    stamp_sizes,
    suited,
)

BAND = Band(1e4, 2e4, 1.5e-5)


def _sky(number=400, alpha=1.0):
    rng = np.random.default_rng(3)
    l, m = rng.uniform(-0.004, 0.004, (2, number))
    size = np.full(number, alpha * ARCSEC)
    return galaxies(l=l, m=m, flux=np.ones(number), alpha=size)


def test_as_many_galaxies_are_drawn_as_the_error_allows():
    wrong, sizes = np.array([3.0, 4.0, 0.1, 12.0]), np.full(4, 80.0)
    assert suited(wrong, sizes, 5.1).tolist() == [0, 1, 2]
    assert suited(wrong, sizes, 4.9).tolist() == [0, 2]
    assert suited(wrong, sizes, 13.1).tolist() == [0, 1, 2, 3]
    sizes[0] = LARGEST_STAMP + 1
    assert suited(wrong, sizes, 13.1).tolist() == [1, 2, 3]


def test_the_error_grows_with_the_size_and_with_w():
    small, large = (relative_error(_sky(1, alpha), 0.0, 1e5, Exponential())[0] for alpha in (1, 2))
    assert large == pytest.approx(4 * small, rel=0.01)
    assert relative_error(_sky(1), 0.0, 2e5, Exponential())[0] == pytest.approx(2 * small, rel=0.01)
    # On long baselines little is left of a large galaxy.
    assert relative_error(_sky(1, 2), 1e5, 1e5, Exponential())[0] < 0.1 * large


def test_stamps_hold_the_galaxies_whose_extent_is_known():
    profile = Exponential()
    sizes = stamp_sizes(_sky(2, 40.0), BAND.pixel, profile)
    assert np.all(sizes >= 2 * profile.extent * 40 * ARCSEC / BAND.pixel)
    assert stamp_sizes(_sky(1, 1e-3), BAND.pixel, profile)[0] >= SMALLEST_STAMP
    assert math.isinf(stamp_sizes(_sky(1), BAND.pixel, Sersic(2.0))[0])


def test_images_are_made_where_they_cost_less_than_the_sum():
    sky, profile = _sky(), Exponential()
    assert cheapest_side(sky, BAND, 1000, 1e4, profile) is None
    assert cheapest_side(sky, BAND, 10_000_000, 1e4, profile) == 1
    assert cheapest_side(sky, BAND, 0, 1e4, profile) is None
    assert cheapest_side(sky.select(np.arange(0)), BAND, 1000, 1e4, profile) is None
    # Smaller tiles need fewer w-planes.
    many, fine = _sky(40_000), Band(1e5, 2e5, 1.5e-6)
    assert 1 < cheapest_side(many, fine, 1_000_000, 3e6, profile) <= MOST_TILES
