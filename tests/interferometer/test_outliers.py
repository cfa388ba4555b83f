"""Visibilities and weights that stand out."""

from dataclasses import replace

import numpy as np
import pytest

from uvshear.interferometer.outliers import outlier_warning, weight_warning
from uvshear.interferometer.samples import Samples

NUMBER, SIGMA = 4000, 2e-3


def samples(noise=SIGMA, seed=1):
    rng = np.random.default_rng(seed)
    deviates = rng.normal(scale=noise, size=(2, NUMBER))
    return Samples(
        uvw=np.zeros((NUMBER, 3)),
        stokes_i=(1 + deviates[0] + 1j * deviates[1]).astype(np.complex64),
        weights=np.full(NUMBER, SIGMA**-2, np.float32),
        frequency=np.full(NUMBER, 1e9),
        bandwidth=np.zeros(NUMBER),
        interval=np.zeros(NUMBER),
        antennas=np.zeros((NUMBER, 2), int),
    )


def sky(seen):
    return np.ones(len(seen), complex)


def with_value(seen, value):
    data = seen.stokes_i.copy()
    data[17] = value
    return replace(seen, stokes_i=data)


@pytest.mark.parametrize("noise", [SIGMA, 30 * SIGMA, 0.0])
def test_noise_has_no_outliers_whatever_its_level(noise):
    for seed in range(20):
        assert outlier_warning("a", samples(noise, seed), sky) is None


@pytest.mark.parametrize(("sigmas", "is_told"), [(7.0, False), (8.0, True), (1e5, True)])
def test_one_visibility_that_is_no_noise_is_told(sigmas, is_told):
    # The limit is sqrt(2 (ln 4000 + 20)) = 7.5 times the noise.
    told = outlier_warning("a", with_value(samples(), 1 + sigmas * SIGMA), sky)
    assert (told is not None) == is_told
    if told is not None:
        assert told.startswith(
            "a: 1 of 4000 visibilities that were looked at are more than 7.5 times"
        )


def test_the_limit_is_that_of_the_noise_that_is_there():
    noisy = samples(10 * SIGMA)
    assert outlier_warning("a", with_value(noisy, 1 + 40 * SIGMA), sky) is None
    assert outlier_warning("a", with_value(noisy, 1 + 90 * SIGMA), sky) is not None


def test_a_sky_that_is_missing_is_no_outlier():
    assert outlier_warning("a", samples(), lambda seen: np.zeros(len(seen), complex)) is None
    half = np.where(np.arange(NUMBER) % 2, 1.0, 0.0) + 0j
    assert outlier_warning("a", samples(), lambda seen: half) is None


def test_too_few_visibilities_are_not_judged():
    few = with_value(samples(), 1e6).select(slice(99))
    assert outlier_warning("a", few, sky) is None
    assert weight_warning("a", np.array([1e9, *[1.0] * 98])) is None


def test_weights_of_few_visibilities_that_outweigh_all_others_are_told():
    weights = np.ones(1000, np.float32)
    assert weight_warning("a", weights) is None
    assert weight_warning("a", np.random.default_rng(1).lognormal(0, 1.5, 1000)) is None
    weights[3] = 1e5
    told = weight_warning("a", weights)
    assert told is not None
    # (1e5 + 999)^2/(1e10 + 999)
    assert "1000 visibilities count for no more than 1 with" in told
    weights[:20] = 1e5
    assert weight_warning("a", weights) is None
