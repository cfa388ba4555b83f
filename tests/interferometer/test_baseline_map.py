"""The map of weights over the length and the angle of baselines."""

import numpy as np
import pytest

from tests.interferometer.chunks import CENTRE, chunk, observation
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.baseline_map import map_baselines, rings_of
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet


def _map(uvw, weights, frequency=SPEED_OF_LIGHT):
    vis = np.zeros(weights.shape, complex)
    block = Visibilities(np.array(uvw), np.array([frequency]), vis, weights)
    return map_baselines(VisibilitySet(CENTRE, (block,)))


def test_all_weight_is_in_the_map():
    seen = observation(1, 2)
    cells = map_baselines(seen)
    total = sum(block.weights.sum() for block in seen.blocks)
    assert cells.weight.sum() == pytest.approx(total)
    np.testing.assert_array_equal(cells.weighted_sum, cells.weight)
    np.testing.assert_array_equal(cells.weighted_sum_of_squares, cells.weight)


def test_a_baseline_and_its_opposite_share_a_cell():
    cells = _map([[300.0, 400.0, 7.0], [-300.0, -400.0, 7.0]], np.array([[1.0], [3.0]]))
    assert len(cells.weight) == 1
    assert (cells.weight[0], cells.u[0], cells.v[0]) == pytest.approx((4.0, 300.0, 400.0))
    assert cells.log_frequency[0] == pytest.approx(np.log(SPEED_OF_LIGHT))
    assert cells.ring[0] == rings_of(np.array([500.0]))[0]


def test_samples_without_weight_are_left_out():
    cells = _map([[300.0, 400.0, 0.0], [0.0, 10.0, 0.0]], np.array([[1.0], [0.0]]))
    assert len(cells.weight) == 1


def test_cells_have_mean_baselines():
    cells = _map([[1000.0, 0.5, 0.0], [1003.0, 0.5, 0.0]], np.array([[1.0], [3.0]]))
    assert cells.u == pytest.approx([1002.25])


def test_factors_of_another_weighting_are_summed_once_and_squared():
    seen = chunk(1)
    data = VisibilitySet(CENTRE, (seen,))

    def factors(block):
        return block.uv_distance / 1e4

    cells = map_baselines(data, factors)
    product = seen.weights * factors(seen)
    assert cells.weighted_sum.sum() == pytest.approx(product.sum())
    assert cells.weighted_sum_of_squares.sum() == pytest.approx((product * factors(seen)).sum())
    np.testing.assert_allclose(cells.weight, map_baselines(data).weight)


def test_lengths_beyond_the_rings_are_in_the_outer_ones():
    rings = rings_of(np.array([1e-9, 1.0, 1e8, 1e20]))
    assert rings[0] == rings[1] == 0
    assert rings[2] == rings[3] == rings.max()
