"""The order of samples: neighbours in the uv plane are neighbours in the order, and nothing is lost."""

import numpy as np

from uvshear.imaging.uv_order import SIDE, uv_order


def _baselines(samples=20_000, longest=3e4):
    return np.random.default_rng(2).uniform(-longest, longest, (samples, 3))


def test_every_sample_comes_once_and_neighbours_come_together():
    uvw = _baselines()
    order = uv_order(uvw)
    np.testing.assert_array_equal(np.sort(order), np.arange(len(uvw)))
    steps = np.abs(np.diff(uvw[order, :2], axis=0))
    square = 2 * np.abs(uvw[:, :2]).max() / SIDE
    # In a random order neighbours are 43 squares from one another along each axis.
    assert np.all(steps[:, 0] < 2 * square)
    assert steps[:, 1].mean() < 1.5 * square


def test_samples_of_one_square_stay_in_their_order():
    uvw = np.repeat(_baselines(7), 50, axis=0)[np.random.default_rng(5).permutation(350)]
    order = uv_order(uvw)
    same = np.all(np.diff(uvw[order], axis=0) == 0, axis=1)
    assert same.sum() == 343
    assert np.all(np.diff(order)[same] > 0)


def test_samples_at_the_edges_of_the_plane_have_a_place():
    corners = np.array([[1.0, 1, 0], [-1, 1, 0], [1, -1, 0], [-1, -1, 0], [0, 0, 5]])
    np.testing.assert_array_equal(np.sort(uv_order(corners)), np.arange(5))
    np.testing.assert_array_equal(uv_order(np.zeros((3, 3))), np.arange(3))
    assert len(uv_order(np.zeros((0, 3)))) == 0


def test_the_unit_does_not_matter():
    uvw = _baselines()
    np.testing.assert_array_equal(uv_order(uvw), uv_order(1024 * uvw))
