"""Pixels against the brightness of galaxies summed over the sky."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import fft

from tests.reference import direct_sum, plane
from tests.skies import galaxies
from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.galaxy import Exponential, Gaussian
from uvshear.imaging.bands import Band
from uvshear.imaging.tiles import Tile
from uvshear.predict import predict_visibilities
from uvshear.predict.rendering import (
    LARGEST_STAMP,
    SMALLEST_STAMP,
    render,
    smooth_step,
    stamp_size,
    transforms_on_stamps,
)

LONGEST = 6e4
PIXEL = 1 / (2.4 * LONGEST)
BAND = Band(0.0, LONGEST, PIXEL)
PROFILES = {"exponential": Exponential(), "gaussian": Gaussian()}
TILE = Tile(0, (900, -700), 200, np.arange(4), -1)
SKY = galaxies(
    np.array([960.3, 1000.0, 1030.48, 970.7]) * PIXEL,
    np.array([-610.1, -600.5, -599.0, -640.2]) * PIXEL,
    np.array([2.0, 1.0, 0.7, 1.3]),
    np.array([2.0, 1.5, 3.0, 0.0]) * ARCSEC,
    np.array([0.3 - 0.2j, -0.5j, 0.0, 0.0]),
)
HALF = np.full(4, 50 * PIXEL)


def _baselines(longest, number=60, seed=3):
    """(u, v, 0) [wavelengths] up to a length, that length among them."""
    rng = np.random.default_rng(seed)
    radius, angle = longest * np.sqrt(rng.uniform(size=number)), rng.uniform(0, 2 * np.pi, number)
    radius[:8] = longest
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(number)])


def _transform(image, tile, pixel, uv):
    """sum I(x) exp(2 pi i k.x) over the pixels of a tile, at their places in the sky."""
    x, y = ((tile.origin[axis] + np.arange(tile.size)) * pixel for axis in (0, 1))
    along = [np.exp(2j * np.pi * k[:, None] * z) for k, z in zip(uv.T, (x, y), strict=True)]
    return np.einsum("ki,ij,kj->k", along[0], image.astype(float), along[1])


@pytest.mark.parametrize("kind", PROFILES)
def test_the_transform_of_the_pixels_is_that_of_the_galaxies_on_all_baselines_of_the_band(kind):
    flux = np.array([0.5, 1.0, 2.0, 0.8])
    uvw = _baselines(LONGEST, 20)
    frequency = np.array([SPEED_OF_LIGHT])
    expected = sum(
        direct_sum.galaxy(
            SKY.l[s],
            SKY.m[s],
            flux[s],
            SKY.ellipticity[s],
            SKY.scale_length[s],
            uvw,
            frequency,
            kind,
        )[:, 0]
        for s in range(4)
    )
    image = render(SKY, flux, HALF, TILE, BAND, PROFILES[kind])
    got = _transform(image, TILE, PIXEL, uvw[:, :2])
    # measured 4e-6; a galaxy half a pixel off: 0.1; its own flux in place of what is given: 1
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-5 * flux.sum())


def test_coarse_pixels_show_the_same_galaxies_to_shorter_baselines():
    band = Band(0.0, LONGEST / 4, 2 * PIXEL)
    tile = Tile(1, (440, -380), 120, np.arange(4), -1)
    uv = _baselines(band.longest)[:, :2]
    expected = sum(
        plane.galaxy(uv, SKY.flux[s], (SKY.l[s], SKY.m[s]), SKY.ellipticity[s], SKY.scale_length[s])
        for s in range(4)
    )
    got = _transform(
        render(SKY, SKY.flux, HALF, tile, band, PROFILES["exponential"]), tile, band.pixel, uv
    )
    np.testing.assert_allclose(got, expected, rtol=0, atol=3e-5 * SKY.flux.sum())


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.5 * PIXEL, -0.4 * PIXEL)])
def test_a_point_source_has_faded_at_the_edge_of_the_smallest_stamp(offset):
    size = SMALLEST_STAMP
    (spectrum,) = transforms_on_stamps(
        np.zeros((1, 3)), np.array([offset]), size, BAND, PROFILES["exponential"]
    )
    stamp = fft.irfft2(spectrum, s=(size, size))
    edge = np.concatenate([stamp[0], stamp[-1], stamp[:, 0], stamp[:, -1]])
    # measured 1.5e-3; with an edge in the uv plane instead of the taper: 3e-2
    assert np.abs(edge).max() < 2.5e-3 * stamp.max()
    assert stamp.sum() == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("origin", [(940, -700), (900, -600), (700, -700), (900, -500)])
def test_a_galaxy_beyond_its_tile_is_an_error(origin):
    tile = replace(TILE, origin=origin)
    with pytest.raises(ValueError, match="reaches beyond its tile"):
        render(SKY, SKY.flux, HALF, tile, BAND, PROFILES["exponential"])


def test_what_a_stamp_leaves_out_of_a_galaxy_falls_with_its_width():
    uv = _baselines(LONGEST)[:, :2]
    first = SKY.select(slice(1))
    expected = plane.galaxy(uv, 2.0, (first.l[0], first.m[0]), 0.3 - 0.2j, 2 * ARCSEC)
    errors = []
    for half in (24, 36, 50):
        image = render(
            first, first.flux, np.array([half * PIXEL]), TILE, BAND, PROFILES["exponential"]
        )
        errors.append(np.abs(_transform(image, TILE, PIXEL, uv) - expected).max())
    # measured 1.5e-4, 2e-6, 1e-6
    assert errors[1] < 0.1 * errors[0]
    assert errors[2] < 5e-6


def test_beyond_the_band_the_transform_falls_to_nothing_at_the_nyquist_frequency():
    nyquist = 0.5 / PIXEL
    uv = np.array([[nyquist, 0.0], [0.0, nyquist], [0.8 * nyquist, 0.7 * nyquist]])
    image = render(SKY, SKY.flux, HALF, TILE, BAND, PROFILES["exponential"])
    assert np.abs(_transform(image, TILE, PIXEL, uv)).max() < 1e-5  # measured 2e-7


@settings(deadline=None)
@given(st.floats(1e-7, 1e-2), st.floats(1e-7, 1e-4))
def test_a_stamp_is_even_quick_to_transform_and_as_wide_as_the_galaxy_matters(half_width, pixel):
    half_width = min(half_width, (LARGEST_STAMP // 2 - 1) * pixel)
    size = stamp_size(half_width, pixel)
    assert size % 2 == 0
    assert size >= max(2 * half_width / pixel, SMALLEST_STAMP)
    assert fft.next_fast_len(size, real=True) == size
    # no wider than need be: the quick even sizes are dense
    assert size <= max(1.15 * (2 * half_width / pixel + 2), SMALLEST_STAMP)


def test_a_smooth_step_falls_from_one_to_zero_between_its_ends():
    x = np.linspace(0.0, 10.0, 501)
    step = smooth_step(x, 3.0, 7.0)
    np.testing.assert_allclose(step[x <= 3.0], 1.0, rtol=0, atol=2e-6)
    np.testing.assert_array_equal(step[x >= 7.0], 0.0)
    assert np.all(np.diff(step) <= 0)
    np.testing.assert_allclose(smooth_step(10 - x, 3.0, 7.0) + step, 1.0, rtol=0, atol=2e-3)
    assert np.abs(np.diff(step)).max() < 0.02  # of 200 steps; a cliff: 1


def test_a_stamp_is_bounded_however_large_a_galaxy_is_said_to_be():
    assert stamp_size(300 * PIXEL, PIXEL) == 600
    for half_width in (800 * PIXEL, 1e5 * PIXEL, np.pi):
        assert stamp_size(half_width, PIXEL) == LARGEST_STAMP


def test_a_galaxy_that_a_stamp_does_not_hold_keeps_its_visibilities():
    """A scale length of 200 pixels, so that 15 per cent of the flux is outside; on baselines it has power on."""
    size = 200 * PIXEL
    galaxy = replace(
        galaxies(0.3 * PIXEL, -0.2 * PIXEL, 1.0, size, 0.2j), spectral_index=np.zeros(1)
    )
    half = np.array([22 * size])
    tile = Tile(0, (-800, -800), 1600, np.arange(1), -1)
    image = render(galaxy, np.ones(1), half, tile, BAND, Exponential())
    uvw = _baselines(2 / (2 * np.pi * size), 30)
    frequency = np.array([SPEED_OF_LIGHT])
    exact = predict_visibilities(galaxy, uvw, frequency, Exponential())[:, 0]
    got = _transform(image, tile, PIXEL, uvw[:, :2])
    assert abs(exact).min() < 0.2
    # measured 0.067 of the whole flux, on the shortest baselines; without what is outside: 0.15
    np.testing.assert_allclose(got, exact, atol=0.08)
    assert image.sum(dtype=float) == pytest.approx(1.0, abs=1e-4)
