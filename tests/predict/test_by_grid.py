"""Visibilities by images of octaves of baselines, against the exact sum over galaxies."""

from dataclasses import replace

import numpy as np
import pytest

from tests.skies import galaxies
from uvshear.constants import ARCSEC, MICROJANSKY, SPEED_OF_LIGHT
from uvshear.execution import SERIAL, in_threads
from uvshear.galaxy import Exponential, Gaussian, Sersic
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.predict import by_grid, drawable, predict_visibilities
from uvshear.predict.by_grid import predict_by_grid

CHANNELS = np.array([1.05e9, 1.2e9, 1.4e9])


@pytest.fixture(scope="module")
def uvw():
    """Every seventh baseline of a short track: lengths from 30 m to 150 km."""
    track = Track.from_clock(PhaseCentre(0.3, -0.5), ((-9000.0, 9000.0),), 3000.0)
    return synthesise(load_layout("ska-mid-aa4"), track).uvw[::7]


@pytest.fixture
def _always_images(monkeypatch):
    """Images for all octaves but those whose images would be huge."""
    monkeypatch.setattr(drawable, "SUM", 1e5)


def _sky(width, number=60, seed=4, centre=(0.0, 0.0)):
    rng = np.random.default_rng(seed)
    l, m = rng.uniform(-width / 2, width / 2, (2, number)) + np.array(centre)[:, None]
    e = 0.4 * np.sqrt(rng.uniform(0, 1, number)) * np.exp(2j * np.pi * rng.uniform(size=number))
    return galaxies(
        l=l,
        m=m,
        flux=rng.uniform(10, 200, number) * MICROJANSKY,
        e=e,
        alpha=rng.uniform(0.2, 1.5, number) * ARCSEC,
        beta=-0.7,
    )


def _rms(x):
    return float(np.sqrt(np.mean(np.abs(x) ** 2)))


@pytest.mark.usefixtures("_always_images")
@pytest.mark.parametrize("profile", [Exponential(), Gaussian()])
@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.25, -0.1)])
def test_images_are_the_sum_to_within_the_error(uvw, profile, centre):
    sky = _sky(0.004, centre=centre)
    exact = predict_visibilities(sky, uvw, CHANNELS[:1], profile)
    error = 3e-6 * _rms(sky.flux) * np.sqrt(len(sky.flux))
    got = predict_by_grid(sky, uvw, CHANNELS[:1], error, profile)
    assert 1e-3 * error < _rms(got - exact) < error
    length = np.hypot(uvw[:, 0], uvw[:, 1])
    for low, high in ((0, 1e3), (1e3, 1e4), (1e4, 3e4), (3e4, 2e5)):
        part = (length >= low) & (length < high)
        assert part.sum() > 100
        assert _rms((got - exact)[part]) < 2 * error


@pytest.mark.usefixtures("_always_images")
def test_every_source_has_its_spectrum(uvw):
    sky = _sky(0.004)
    sky = replace(sky, spectral_index=np.linspace(-1.5, 0.5, len(sky.flux)))
    exact = predict_visibilities(sky, uvw, CHANNELS)
    error = 3e-6 * _rms(sky.flux) * np.sqrt(len(sky.flux))
    assert _rms(predict_by_grid(sky, uvw, CHANNELS, error) - exact) < error


def test_galaxies_that_are_too_bright_or_too_large_are_summed(uvw, monkeypatch):
    monkeypatch.setattr(drawable, "SUM", 1e5)
    sky = _sky(0.004)
    flux, size = sky.flux.copy(), sky.scale_length.copy()
    flux[3], size[5] = 1.0, 40 * ARCSEC
    sky = replace(sky, flux=flux, scale_length=size)
    exact = predict_visibilities(sky, uvw, CHANNELS[:1])
    error = 1e-8
    assert _rms(predict_by_grid(sky, uvw, CHANNELS[:1], error) - exact) < error
    # Images of the bright one alone would be wrong by more.
    monkeypatch.setattr(by_grid, "suited", lambda galaxies, *_: np.array([3]))
    assert _rms(predict_by_grid(sky, uvw, CHANNELS[:1], error) - exact) > 5 * error


@pytest.mark.usefixtures("_always_images")
def test_galaxies_with_long_tails_are_summed(uvw):
    """Images of such a galaxy, cut at the extent of an exponential disc, are wrong by 8e-5 of its flux."""
    sky, error = _sky(0.004), 1e-8
    exact = predict_visibilities(sky, uvw, CHANNELS[:1], Sersic(2.0))
    got = predict_by_grid(sky, uvw, CHANNELS[:1], error, Sersic(2.0))
    assert _rms(got - exact) < error


@pytest.mark.parametrize(("profile", "beyond"), [(Exponential(), 1e-6), (Gaussian(), 1e-6)])
def test_a_millionth_of_the_flux_lies_beyond_the_extent(profile, beyond):
    r = np.linspace(profile.extent, 4 * profile.extent, 100_001)
    tail = np.exp(-r) if isinstance(profile, Exponential) else np.exp(-(r**2) / 2)
    assert np.sum(r * tail) * (r[1] - r[0]) == pytest.approx(beyond, rel=0.1)


@pytest.mark.usefixtures("_always_images")
def test_the_flux_in_the_band_decides_not_that_at_the_reference(uvw):
    """At 1 GHz sources of such spectra are a thousand times as bright as at the reference frequency of 1.4 GHz."""
    sky = replace(_sky(0.004), spectral_index=np.full(60, -20.0))
    error = 1e-8
    exact = predict_visibilities(sky, uvw, CHANNELS[:1])
    assert _rms(predict_by_grid(sky, uvw, CHANNELS[:1], error) - exact) < error


def test_without_an_error_the_sum_is_exact(uvw):
    sky = _sky(0.004)
    got = predict_by_grid(sky, uvw, CHANNELS, 0.0)
    np.testing.assert_allclose(got, predict_visibilities(sky, uvw, CHANNELS), atol=1e-17)


@pytest.mark.usefixtures("_always_images")
def test_the_executor_does_not_change_a_bit(uvw, monkeypatch):
    monkeypatch.setattr(by_grid, "SLAB", 1000)
    sky = _sky(0.004)
    one, three = (
        predict_by_grid(sky, uvw, CHANNELS, 1e-8, executor=executor)
        for executor in (SERIAL, in_threads(3))
    )
    np.testing.assert_array_equal(one, three)


@pytest.mark.parametrize("number", [0, 1])
def test_a_sky_of_no_galaxy_or_of_one(uvw, number):
    sky = _sky(0.004).select(np.arange(number))
    got = predict_by_grid(sky, uvw[:50], CHANNELS, 1e-9)
    exact = predict_visibilities(sky, uvw[:50], CHANNELS)
    np.testing.assert_allclose(got, exact, atol=1e-9)


def test_rows_without_a_baseline_have_the_total_flux():
    sky = _sky(0.004)
    sky = replace(sky, reference_frequency=float(CHANNELS[0]))
    got = predict_by_grid(sky, np.zeros((3, 3)), CHANNELS[:1], 1e-9)
    np.testing.assert_allclose(got, sky.flux.sum(), atol=1e-9)


def test_the_baselines_that_represent_an_octave_have_all_channels(monkeypatch):
    seen = []

    def spy(galaxies, uvw, profile):
        seen.append(np.linalg.norm(uvw, axis=1) * SPEED_OF_LIGHT / 1e3)
        return drawable.relative_error(galaxies, uvw, profile)

    monkeypatch.setattr(by_grid, "relative_error", spy)
    directions = np.random.default_rng(1).normal(size=(500, 3))
    uvw = 1e3 * directions / np.linalg.norm(directions, axis=1)[:, None]
    channels = np.linspace(0.95e9, 1.7e9, 300)
    predict_by_grid(_sky(0.004), uvw, channels, 1e-5)
    frequency = np.concatenate(seen)
    assert len(frequency) >= by_grid.PROBES
    assert frequency.min() < 1.0e9
    assert frequency.max() > 1.65e9
    assert np.mean(frequency) == pytest.approx(np.mean(channels), rel=0.02)
