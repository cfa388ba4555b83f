"""The choice between images and the sum."""

import math

import numpy as np
import pytest

from tests.skies import galaxies
from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential, Gaussian, Sersic
from uvshear.imaging.bands import Band
from uvshear.predict.drawable import (
    LARGEST_STAMP,
    MOST_TILES,
    RELATIVE_ERROR,
    SMALLEST_STAMP,
    TileCosts,
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


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.2, -0.3)])
def test_the_error_is_that_of_the_phase_across_a_galaxy(place):
    """The transform of a round Gaussian with the phase -pi w r^2 is known."""
    rng = np.random.default_rng(5)
    alpha, (l, m) = 4.0 * ARCSEC, place
    n = math.sqrt(1 - l**2 - m**2)
    sky = galaxies(l=[l], m=[m], flux=[1.0], alpha=[alpha])
    x, y, w = rng.normal(size=(3, 50)) * np.array([1e4, 1e4, 1e5])[:, None]
    u, v, seen = x + w * l / n, y + w * m / n, x**2 + y**2
    along = u * l + v * m + w * n
    wider = 1 / (1 / alpha**2 + 2j * math.pi * along)
    exact = wider / alpha**2 * np.exp(-2 * math.pi**2 * wider * seen)
    summed = np.exp(-2 * math.pi**2 * alpha**2 * seen)
    expected = np.sqrt(np.mean(np.abs(exact - summed) ** 2))
    found = relative_error(sky, np.column_stack([u, v, w]), Gaussian())
    assert expected > 50 * RELATIVE_ERROR
    assert found == pytest.approx([expected], rel=0.03)


def test_where_w_is_zero_the_error_is_that_of_drawing():
    baselines = np.array([[1e4, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert relative_error(_sky(2), baselines, Exponential()) == pytest.approx(
        RELATIVE_ERROR, rel=1e-3
    )
    assert relative_error(_sky(2), baselines[:0], Exponential()) == pytest.approx(RELATIVE_ERROR)


@pytest.mark.parametrize("alpha", [0.0, 1e-300])
def test_the_error_of_a_point_source_is_that_of_drawing(alpha):
    baselines = np.array([[1e4, 0.0, 1e5], [0.0, 0.0, 0.0]])
    found = relative_error(_sky(2, alpha), baselines, Exponential())
    assert found == pytest.approx(RELATIVE_ERROR)


def test_stamps_hold_the_galaxies_whose_extent_is_known():
    profile = Exponential()
    sizes = stamp_sizes(_sky(2, 40.0), BAND.pixel, profile)
    assert np.all(sizes >= 2 * profile.extent * 40 * ARCSEC / BAND.pixel)
    assert stamp_sizes(_sky(1, 1e-3), BAND.pixel, profile)[0] >= SMALLEST_STAMP
    assert math.isinf(stamp_sizes(_sky(1), BAND.pixel, Sersic(2.0))[0])


def test_images_are_made_where_they_cost_less_than_the_sum():
    sky, profile = _sky(), Exponential()
    assert cheapest_side(sky, BAND, 1000, 1e4, profile) is None
    side, costs = cheapest_side(sky, BAND, 10_000_000, 1e4, profile)
    assert (side, costs.tiles) == (1, 1)
    assert cheapest_side(sky, BAND, 0, 1e4, profile) is None
    assert cheapest_side(sky.select(np.arange(0)), BAND, 1000, 1e4, profile) is None
    # Smaller tiles need fewer w-planes.
    many, fine = _sky(40_000), Band(1e5, 2e5, 1.5e-6)
    side, costs = cheapest_side(many, fine, 1_000_000, 3e6, profile)
    assert 1 < side <= MOST_TILES
    assert costs.tiles == side**2


def test_a_channel_more_costs_less_than_a_row_more():
    costs = TileCosts(1, 0.0, 1e6)
    one = costs.call(1000, 1)
    assert one < costs.call(1000, 2) < costs.call(2000, 1) < 2 * one
