"""Thermal noise."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import CorrelationNoise, ScaledNoise, StokesINoise
from uvshear.interferometer.spectral_window import Channels

CHANNELS = Channels.from_band(950e6, 1190e6, 1)


@pytest.fixture(scope="module")
def coverage():
    track = Track(PhaseCentre(0.0, -0.5), ((0.0, 0.001),), 60.0)
    return synthesise(load_layout("ska-mid-aa4"), track)


def test_stokes_i_noise_is_the_paper_s(coverage):
    # 400 / (0.9 sqrt(2 * 240e6 * 60)) = 2.6189e-3 Jy, by hand
    sigma = StokesINoise(400.0).correlation_sigma(coverage, CHANNELS)
    np.testing.assert_allclose(sigma / np.sqrt(2), 2.61891e-3, rtol=1e-5)
    assert sigma.shape == (len(coverage), 1)


def test_ten_microjansky_in_eight_hours_is_ten_sigma(coverage):
    # Rivi & Miller 2018, section 3: 10 uJy at 10 sigma
    sigma = StokesINoise(400.0).correlation_sigma(coverage, CHANNELS)[0, 0] / np.sqrt(2)
    snr = 10e-6 * np.sqrt(480 * 197 * 196 / 2) / sigma
    assert snr == pytest.approx(11.6, abs=0.1)


def test_noise_of_each_correlation_is_sqrt2_less_than_noise_of_stokes_i(coverage):
    stokes_i = StokesINoise(400.0).correlation_sigma(coverage, CHANNELS)
    correlation = CorrelationNoise(400.0).correlation_sigma(coverage, CHANNELS)
    np.testing.assert_allclose(stokes_i / correlation, np.sqrt(2))


def test_two_kinds_of_dish_make_three_kinds_of_baseline(coverage):
    sigma = CorrelationNoise(((13.5, 500.0), (15.0, 320.0)), 1.0).correlation_sigma(
        coverage, CHANNELS
    )[:, 0]
    large = coverage.layout.diameters == 15.0
    kinds = large[coverage.antenna1].astype(int) + large[coverage.antenna2]
    unit = np.sqrt(2 * 240e6 * 60)
    for kind, sefd in enumerate((500.0, 400.0, 320.0)):
        np.testing.assert_allclose(sigma[kinds == kind], sefd / unit)


def test_noise_falls_with_the_root_of_the_channel_s_width(coverage):
    channels = Channels(np.array([1e9, 2e9]), np.array([1e6, 4e6]))
    sigma = CorrelationNoise(400.0).correlation_sigma(coverage, channels)
    np.testing.assert_allclose(sigma[:, 0] / sigma[:, 1], 2)


def test_scaled_noise_gives_a_point_source_its_snr(coverage):
    noise = ScaledNoise(10e-6 * np.sqrt(len(coverage)) / 10.0)
    stokes_i_sigma = noise.correlation_sigma(coverage, CHANNELS) / np.sqrt(2)
    np.testing.assert_allclose(stokes_i_sigma, noise.stokes_i_sigma)
    assert 10e-6 * np.sqrt(np.sum(stokes_i_sigma**-2)) == pytest.approx(10)


def test_a_dish_without_sefd_is_named(coverage):
    with pytest.raises(InputError, match=r"dishes of 15 m without an SEFD"):
        CorrelationNoise(((13.5, 500.0),)).correlation_sigma(coverage, CHANNELS)


@pytest.mark.parametrize("sefd", [0.0, -1.0, float("nan"), ((15.0, 0.0),)])
def test_an_sefd_is_positive(sefd):
    with pytest.raises(InputError, match="must be positive"):
        StokesINoise(sefd)


@pytest.mark.parametrize("efficiency", [0.0, 1.1, float("nan")])
def test_an_efficiency_is_a_fraction(efficiency):
    with pytest.raises(InputError, match="efficiency"):
        CorrelationNoise(400.0, efficiency)


def test_scaled_noise_is_positive():
    with pytest.raises(InputError, match="must be positive"):
        ScaledNoise(0.0)
