"""Containers of visibilities."""

import numpy as np

from tests.interferometer.chunks import CENTRE, chunk
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.visibilities import Observation, Visibilities, VisibilitySet


def test_the_uv_distance_leaves_w_out():
    block = Visibilities(
        np.array([[3.0, 4.0, 100.0]]),
        np.array([SPEED_OF_LIGHT, 2 * SPEED_OF_LIGHT]),
        np.zeros((1, 2), complex),
        np.ones((1, 2)),
    )
    np.testing.assert_allclose(block.uv_distance, [[5.0, 10.0]])


def test_other_visibilities_leave_the_rest():
    block = chunk(1)
    other = block.with_stokes_i(2 * block.stokes_i)
    np.testing.assert_array_equal(other.stokes_i, 2 * block.stokes_i)
    assert other.weights is block.weights
    assert other.counts is block.counts


def test_integrations_are_selected_by_row():
    first = chunk(1).integrations.select(slice(0, 3))
    np.testing.assert_array_equal(first.time, [100.0] * 3)
    assert first.antennas.shape == (3, 2)


def test_a_set_in_memory_is_an_observation():
    data = VisibilitySet(CENTRE, (chunk(1), chunk(2)))
    assert isinstance(data, Observation)
    assert [len(block) for block in data.chunks()] == [240, 240]
