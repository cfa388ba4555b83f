"""The expansion of n about the centre of a tile, and the widths that it allows."""

import math

import numpy as np
import pytest

from uvshear.imaging.curvature import (
    LEAST_N,
    TOLERANCE,
    half_width_within,
    half_widths_of_bands,
    mean_curvature,
    touching_point,
)


def _n(l, m):
    return math.sqrt(1 - l**2 - m**2)


@pytest.mark.parametrize("radius", [0.0, 0.1, 0.7])
def test_the_mean_curvature_is_that_of_n(radius):
    step, n = 1e-4, _n(radius, 0)
    along = (_n(radius + step, 0) + _n(radius - step, 0) - 2 * n) / step**2
    across = 2 * (_n(radius, step) - n) / step**2
    assert mean_curvature(n) == pytest.approx(-(along + across) / 2, rel=1e-5)


def _phase(radius, x, y, w):
    """Error of the plane tangent at (radius, 0), with the gridder's round curvature [rad]."""
    n = _n(radius, 0)
    plane = n - radius / n * x + mean_curvature(n) * (_n(x, y) - 1)
    return abs(2 * math.pi * w * (_n(radius + x, y) - plane))


@pytest.mark.parametrize("radius", [0.01, 0.09, 0.5])
@pytest.mark.parametrize("w", [30.0, 1e3, 1e5])
def test_the_phase_error_at_the_edge_of_the_widest_tile_is_the_tolerance(radius, w):
    half = half_width_within(radius, w)
    angles = np.linspace(0, 2 * math.pi, 24)
    worst = max(_phase(radius, half * np.cos(a), half * np.sin(a), w) for a in angles)
    # half of the tolerance for each of two terms; the fourth order is neglected
    assert TOLERANCE / 3 < worst < TOLERANCE * 1.4


def test_nothing_limits_a_tile_at_the_phase_centre_or_without_w():
    assert half_width_within(0.0, 1e5) == math.inf
    assert half_width_within(0.9, 0.0) == math.inf


def test_each_band_has_the_limit_of_its_own_w():
    uvw = np.array([[1.0, 0, 3e4], [1.0, 0, 4e4], [1.0, 0, -1e3]])
    limits = half_widths_of_bands(uvw, np.array([0, 0, 2]), 3, 0.05)
    rms = math.sqrt((3e4**2 + 4e4**2) / 2)
    expected = (half_width_within(0.05, rms), math.inf, half_width_within(0.05, 1e3))
    assert limits == pytest.approx(expected)


def test_a_plane_touches_the_sphere_above_the_horizon():
    assert touching_point(0.3, -0.4) == (0.3, -0.4, _n(0.3, 0.4))
    for place in ((0.6, 0.8), (1.2, -0.9), (0.0, -1.0)):
        l, m, n = touching_point(*place)
        assert n == LEAST_N
        assert l**2 + m**2 + n**2 == pytest.approx(1, rel=1e-12)
        assert l * place[1] == pytest.approx(m * place[0], abs=1e-12)
