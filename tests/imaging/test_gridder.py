"""The three transforms of the gridder against direct sums, and against one another."""

import numpy as np
import pytest

from tests.reference import direct_sum, dirty
from tests.skies import random_baselines
from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.gridder import POINT_EPSILON, degrid, grid, visibilities_at

FREQUENCY = np.array([1.2e9, 1.5e9])
IMAGE = ImageGrid(32, 2e-5, 0.006, -0.003)


def _baselines():
    return random_baselines(60, 2e3, seed=5, depth=1.0)


def _directions(image):
    x = (np.arange(image.size) - image.size // 2) * image.pixel
    return np.meshgrid(image.l0 + x, image.m0 + x, indexing="ij")


def _vis(shape=(60, 2)):
    rng = np.random.default_rng(4)
    return rng.normal(size=shape) + 1j * rng.normal(size=shape)


def test_an_image_of_unit_weights_is_the_direct_sum():
    uvw, vis = _baselines(), _vis()
    got = grid(uvw, FREQUENCY, vis, IMAGE, epsilon=1e-10, with_w=True)
    expected = dirty.dirty_image(uvw, FREQUENCY, vis, np.ones(vis.shape), *_directions(IMAGE))
    # any sign of u, v, w or of the centre wrong: 1
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_visibilities_of_an_image_are_the_direct_sum_over_its_pixels():
    uvw = _baselines()
    pixels = np.random.default_rng(3).uniform(size=(32, 32))
    got = degrid(uvw, FREQUENCY, pixels, IMAGE, epsilon=1e-10, with_w=True)
    l, m = _directions(IMAGE)
    expected = direct_sum.point_sources(l.ravel(), m.ravel(), pixels.ravel(), uvw, FREQUENCY)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("with_w", [True, False])
def test_degridding_is_the_adjoint_of_gridding(with_w):
    uvw, vis = _baselines(), _vis()
    pixels = np.random.default_rng(3).normal(size=(32, 32))
    how = {"epsilon": 1e-10, "with_w": with_w}
    on_sky = np.sum(pixels * grid(uvw, FREQUENCY, vis, IMAGE, **how))
    on_baselines = np.sum(np.real(vis.conj() * degrid(uvw, FREQUENCY, pixels, IMAGE, **how)))
    assert on_sky == pytest.approx(on_baselines, abs=1e-8 * np.linalg.norm(vis) * 32)


def test_points_of_the_uv_plane_are_direct_sums_over_a_complex_image():
    image, pixel = _vis((11, 11)), 3e-6
    uv = np.random.default_rng(6).uniform(-1e5, 1e5, (40, 2))
    x = (np.arange(11) - 5) * pixel
    phase = np.exp(2j * np.pi * (uv[:, :1, None] * x[:, None] + uv[:, 1:, None] * x[None, :]))
    expected = np.sum(image * phase, axis=(1, 2))
    got = visibilities_at(image, pixel, uv)
    # the sign of the phase wrong: 1
    assert np.linalg.norm(got - expected) < 3 * POINT_EPSILON * np.linalg.norm(expected)
