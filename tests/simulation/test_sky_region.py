"""Regions of the sky."""

import math

import numpy as np
import pytest

from uvshear.simulation.sky_region import DiscField, SquareField


@pytest.mark.parametrize("region", [SquareField(0.02), DiscField(0.01)])
def test_directions_fill_the_region_evenly(region):
    l, m = region.draw(40_000, np.random.default_rng(1))
    assert max(np.abs(l).max(), np.abs(m).max()) <= 0.01
    # A disc of a quarter of the radius holds its share of the area: 5 standard deviations of 50 per cent.
    inner = np.hypot(l, m) < 0.005
    expected = math.pi * 0.005**2 / region.area
    assert inner.mean() == pytest.approx(expected, abs=5 * 0.5 / 200)


def test_areas_are_those_of_geometry():
    assert SquareField(0.02).area == pytest.approx(4e-4)
    assert DiscField(0.01).area == pytest.approx(math.pi * 1e-4)
