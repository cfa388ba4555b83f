"""The dirty image against direct sums, and as the adjoint of the prediction."""

import numpy as np
import pytest

from tests.reference import dirty
from tests.skies import galaxies, random_baselines
from uvshear.imaging import ImageGrid, dirty_image
from uvshear.predict import predict_visibilities

FREQUENCY = np.array([1.2e9, 1.5e9])

TOLERANCES = [
    # dtype, epsilon asked, greatest error in rms allowed (measured: 3.4e-6, 2.5e-7, 1.4e-12)
    (np.complex64, 1e-5, 1e-5),
    (np.complex128, 1e-6, 1e-6),
    (np.complex128, 1e-12, 1e-11),
]


def _data(rows=300, seed=5):
    rng = np.random.default_rng(seed)
    uvw = random_baselines(rows, 2e3, seed=seed, depth=1.0)
    vis = rng.normal(size=(2, rows, 2))
    return uvw, vis[0] + 1j * vis[1], rng.uniform(0.5, 2, (rows, 2))


def _directions(grid):
    x = (np.arange(grid.size) - grid.size // 2) * grid.pixel
    return np.meshgrid(grid.l0 + x, grid.m0 + x, indexing="ij")


def _rms(x):
    return float(np.sqrt(np.mean(np.abs(x) ** 2)))


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.009, -0.004)])
@pytest.mark.parametrize(("dtype", "epsilon", "allowed"), TOLERANCES)
def test_the_dirty_image_is_the_direct_sum(dtype, epsilon, allowed, centre):
    uvw, vis, weights = _data()
    grid = ImageGrid(24, 2e-5, *centre)
    expected = dirty.dirty_image(uvw, FREQUENCY, vis, weights, *_directions(grid))
    got = dirty_image(uvw, FREQUENCY, vis.astype(dtype), weights, grid, epsilon=epsilon)
    # any sign of u, v, w, of the centre, or the order of axes wrong: 1.4
    assert _rms(got - expected) < allowed * _rms(expected)


def test_masked_visibilities_take_no_part():
    uvw, vis, weights = _data()
    grid = ImageGrid(16, 2e-5)
    keep = np.random.default_rng(1).uniform(size=vis.shape) < 0.7
    got = dirty_image(uvw, FREQUENCY, vis, weights, grid, mask=keep, epsilon=1e-10)
    expected = dirty_image(uvw, FREQUENCY, vis, weights * keep, grid, epsilon=1e-10)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


def test_a_source_to_the_north_east_stands_at_larger_l_and_m():
    uvw, _, weights = _data()
    sky = galaxies(5 * 2e-5, 2 * 2e-5, alpha=0.0)
    vis = predict_visibilities(sky, uvw, FREQUENCY)
    image = dirty_image(uvw, FREQUENCY, vis, weights, ImageGrid(24, 2e-5))
    assert np.unravel_index(np.argmax(image), image.shape) == (12 + 5, 12 + 2)


def test_without_w_it_is_the_image_of_a_flat_array():
    uvw, vis, weights = _data()
    grid = ImageGrid(24, 2e-4)
    flat = uvw * (1, 1, 0)
    expected = dirty_image(flat, FREQUENCY, vis, weights, grid, epsilon=1e-8)
    got = dirty_image(uvw, FREQUENCY, vis, weights, grid, with_w=False, epsilon=1e-8)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-6 * np.abs(expected).max())
    exact = dirty_image(uvw, FREQUENCY, vis, weights, grid, epsilon=1e-8)
    assert _rms(got - exact) > 0.05 * _rms(exact)  # w matters on this grid: 0.076


def test_imaging_is_the_adjoint_of_prediction():
    uvw, vis, weights = _data()
    grid = ImageGrid(20, 2e-5, 0.006, 0.003)
    rng = np.random.default_rng(8)
    i, j = rng.integers(0, 20, (2, 15))
    flux = rng.uniform(0.5, 2, 15)
    l, m = (x[i, j] for x in _directions(grid))
    model = predict_visibilities(galaxies(l, m, flux, alpha=0.0, beta=0.0), uvw, FREQUENCY)
    image = dirty_image(uvw, FREQUENCY, vis, weights, grid, epsilon=1e-11)
    of_image = float(np.sum(flux * image[i, j]))
    # a missing conjugate: 1e-2
    scale = np.sqrt(dirty.inner(weights, vis, vis) * dirty.inner(weights, model, model))
    assert abs(of_image - dirty.inner(weights, vis, model)) < 1e-9 * scale


def test_the_image_is_linear_in_the_visibilities():
    uvw, vis, weights = _data()
    grid = ImageGrid(16, 2e-5)

    def image(v):
        return dirty_image(uvw, FREQUENCY, v, weights, grid, epsilon=1e-11)

    other = np.roll(vis, 7, axis=0)
    expected = 2 * image(vis) - 3 * image(other)
    np.testing.assert_allclose(
        image(2 * vis - 3 * other), expected, rtol=0, atol=1e-8 * _rms(expected)
    )


def test_channels_of_a_lower_sideband_make_the_same_image():
    """The gridder itself refuses frequencies that fall."""
    rng = np.random.default_rng(8)
    uvw = rng.normal(size=(40, 3)) * 300
    frequency = np.array([1.0e9, 1.1e9, 1.3e9])
    vis = rng.normal(size=(40, 3)) + 1j * rng.normal(size=(40, 3))
    weights = rng.uniform(1, 2, size=(40, 3))
    grid = ImageGrid(64, 1e-5)
    mask = rng.uniform(size=(40, 3)) > 0.3
    rising = dirty_image(uvw, frequency, vis, weights, grid, mask=mask)
    falling = dirty_image(
        uvw, frequency[::-1], vis[:, ::-1], weights[:, ::-1], grid, mask=mask[:, ::-1]
    )
    np.testing.assert_allclose(falling, rising, rtol=0, atol=1e-12 * np.abs(rising).max())
