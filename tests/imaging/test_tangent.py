"""Tiles against direct sums, 0.7 deg from the phase centre and at w of several 1e5 wavelengths."""

import numpy as np
import pytest

from tests.reference import direct_sum, dirty
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.imaging.tangent import TangentPlane

IN_WAVELENGTHS = np.array([SPEED_OF_LIGHT])
L, M = 0.0098, -0.0073  # 0.7 deg
SIZE, PIXEL = 768, 4e-6
"""Half of it, 0.09 deg: w x^2/2 is 1.2 turns in the corners for w = 5e5."""


def _baselines(samples=150, longest=1.0e5, w=5e5, seed=3):
    rng = np.random.default_rng(seed)
    radius, angle = longest * rng.uniform(size=samples), rng.uniform(0, 2 * np.pi, samples)
    depth = w * rng.uniform(-1, 1, samples)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), depth])


def _vis(samples=150, seed=4):
    rng = np.random.default_rng(seed)
    return (rng.normal(size=samples) + 1j * rng.normal(size=samples)).astype(np.complex64)


def _pixels(number=200, size=SIZE, seed=5):
    """Some pixels of a tile, its corners among them."""
    rng = np.random.default_rng(seed)
    i, j = rng.integers(0, size, (2, number))
    i[:4], j[:4] = (0, 0, size - 1, size - 1), (0, size - 1, 0, size - 1)
    return i, j


def _direction(i, j, size=SIZE, pixel=PIXEL):
    return L + (i - size // 2) * pixel, M + (j - size // 2) * pixel


def _rms(x):
    return float(np.sqrt(np.mean(np.abs(x) ** 2)))


ALLOWED = [
    # w, error in rms (measured: 4e-4, the third order of w (n-1), 2e-4 turns in the corners; 1e-6)
    (5e5, 6e-4),
    # products instead of w-planes: 4e-5, a tenth of it
    (5e4, 6e-5),
    (0.0, 3e-6),
]


@pytest.mark.parametrize(("w", "allowed"), ALLOWED)
def test_a_tile_is_the_direct_sum_over_visibilities(w, allowed):
    uvw, vis = _baselines(w=w), _vis()
    i, j = _pixels()
    ones = np.ones((len(uvw), 1))
    expected = dirty.dirty_image(uvw, IN_WAVELENGTHS, vis[:, None], ones, *_direction(i, j))
    got = TangentPlane.at(uvw, L, M).image(vis, SIZE, PIXEL, 1e-5)[i, j]
    # without the shift of (u, v), or with its sign or that of w wrong: 1.4
    assert _rms(got - expected) < allowed * _rms(expected)


@pytest.mark.parametrize(("w", "allowed"), ALLOWED)
def test_predictions_of_a_tile_are_the_direct_sum_over_its_pixels(w, allowed):
    uvw = _baselines(w=w)
    i, j = _pixels(40)
    flux = np.random.default_rng(1).uniform(0.5, 2, len(i))
    image = np.zeros((SIZE, SIZE), np.float32)
    np.add.at(image, (i, j), flux)
    expected = direct_sum.point_sources(*_direction(i, j), flux, uvw, IN_WAVELENGTHS)[:, 0]
    got = TangentPlane.at(uvw, L, M).visibilities(image, PIXEL, 1e-5)
    assert _rms(got - expected) < allowed * _rms(expected)


@pytest.mark.parametrize("size", [64, SIZE])  # one plane, and many of w
def test_predicting_is_the_adjoint_of_imaging(size):
    uvw, vis = _baselines(), _vis()
    plane = TangentPlane.at(uvw, L, M)
    image = np.random.default_rng(2).normal(size=(size, size)).astype(np.float32)
    model = plane.visibilities(image, PIXEL, 1e-5)
    on_sky = float(np.sum(image * plane.image(vis, size, PIXEL, 1e-5), dtype=float))
    on_baselines = float(np.sum(np.real(vis.conj() * model), dtype=float))
    # measured 1e-8; a conjugate missing: 1e-1
    assert abs(on_sky - on_baselines) < 1e-7 * np.linalg.norm(vis) * np.linalg.norm(model)


def test_the_beam_is_the_image_of_a_point_source_at_the_direction():
    uvw = _baselines()
    weights = np.random.default_rng(2).uniform(0.5, 2, len(uvw))
    size = 64
    i, j = _pixels(size=size)
    source = direct_sum.point_sources(L, M, 1.0, uvw, IN_WAVELENGTHS)
    expected = dirty.dirty_image(
        uvw, IN_WAVELENGTHS, source, weights[:, None], *_direction(i, j, size)
    )
    got = TangentPlane.at(uvw, L, M).beam(weights.astype(np.complex64), size, PIXEL, 1e-5)
    # measured 1.2e-2: w x^2/2, 8e-3 turns in the corners at the largest w; baselines as from the phase centre: 1.4
    assert _rms(got[i, j] - expected) < 2e-2 * _rms(expected)
    assert got[size // 2, size // 2] == pytest.approx(weights.sum(), rel=1e-4)
    assert np.unravel_index(np.argmax(got), got.shape) == (size // 2, size // 2)


def test_a_point_source_at_the_direction_has_the_phase_of_the_plane():
    uvw = _baselines()
    expected = direct_sum.point_sources(L, M, 1.0, uvw, IN_WAVELENGTHS)[:, 0]
    # measured 4e-8: single precision
    np.testing.assert_allclose(TangentPlane.at(uvw, L, M).phase, expected, rtol=0, atol=2e-7)
