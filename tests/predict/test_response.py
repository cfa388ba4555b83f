"""Factors of sources over samples, and those of many in terms of a few."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.skies import galaxies, random_baselines
from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.attenuation import BandwidthSmearing, CombinedAttenuation, TimeSmearing
from uvshear.interferometer.primary_beam import AiryBeam
from uvshear.interferometer.samples import Samples
from uvshear.predict.response import FILTER_TOLERANCE, TOLERANCE, Response, SharedFactors, seen_as

LOW, HIGH = 0.95e9, 1.76e9  # SKA-Mid's band 2
DECLINATION = -0.5


def _sky(indices, l=1e-3):
    count = len(indices)
    return galaxies(
        np.linspace(-l, l, count), 0.3 * l, np.linspace(1.0, 2.0, count), beta=np.array(indices)
    )


def _samples(number=500, low=LOW, high=HIGH, seed=1):
    rng = np.random.default_rng(seed)
    frequency = rng.uniform(low, high, number)
    uvw = random_baselines(number, 1e4, seed=seed) * (frequency / SPEED_OF_LIGHT)[:, None]
    return Samples(
        uvw=uvw,
        stokes_i=np.zeros(number, np.complex64),
        weights=rng.uniform(0.5, 2, number).astype(np.float32),
        frequency=frequency,
        bandwidth=np.full(number, 1e6, np.float32),
        interval=np.full(number, 8.0, np.float32),
        antennas=np.zeros((number, 2), np.int16),
    )


def _factor(response, samples, sky, source):
    own = response.source_factor(
        samples, float(sky.l[source]), float(sky.m[source]), float(sky.spectral_index[source])
    )
    return own * response.gain(samples.frequency)


def _shared_error(response, sky, samples):
    """Largest difference of a factor and its combination of the few, on samples that chose nothing."""
    shared = response.shared_factors(sky, 0.0, np.inf)
    few = np.stack([_factor(response, samples, sky, k) for k in shared.chosen.tolist()])
    every = np.stack([_factor(response, samples, sky, k) for k in range(len(sky))])
    return np.abs(shared.coefficients.T @ few - every).max(), len(shared.chosen)


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-2.0, 1.5), min_size=1, max_size=6), st.floats(1.01, 1.86))
def test_a_few_spectra_make_all_power_laws_over_the_band(indices, ratio):
    sky = _sky(indices)
    probes, others = (_samples(high=ratio * LOW, seed=seed) for seed in (1, 2))
    response = Response.from_sky(sky, probes)
    error, _ = _shared_error(response, sky, others)
    for source, index in enumerate(indices):
        truth = (others.frequency / 1.4e9) ** index
        np.testing.assert_allclose(_factor(response, others, sky, source), truth, rtol=1e-6)
    assert error < 10 * TOLERANCE


def test_sources_of_one_index_are_one_and_need_no_probes():
    response = Response.from_sky(_sky([-0.7] * 4))
    shared = response.shared_factors(_sky([-0.7] * 4), 0.0, np.inf)
    np.testing.assert_array_equal(shared.coefficients, np.ones((1, 4)))
    assert response.source_factor(_samples(), 0.1, 0.1, -0.7) == 1.0
    np.testing.assert_array_equal(response.strengths(_sky([-0.7] * 4)), 1.0)
    assert response.index == -0.7


def test_no_sources_are_none():
    nobody = _sky([-0.7]).select(np.zeros(0, int))
    assert len(Response.from_sky(nobody).strengths(nobody)) == 0


EVERYTHING = CombinedAttenuation(
    (BandwidthSmearing(), TimeSmearing(DECLINATION), AiryBeam.from_diameters(np.array([13.5])))
)


@pytest.mark.parametrize("attenuation", [EVERYTHING, BandwidthSmearing()])
def test_a_few_places_make_those_of_a_tile(attenuation):
    """A tile of a quarter of a degree, three quarters off the centre."""
    rng = np.random.default_rng(3)
    count = 60
    sky = galaxies(
        np.radians(0.6 + rng.uniform(-0.12, 0.12, count)),
        np.radians(-0.4 + rng.uniform(-0.12, 0.12, count)),
        1.0,
        beta=rng.choice([-0.7, -0.5], count),
    )
    response = Response.from_sky(sky, _samples(2000), attenuation)
    error, terms = _shared_error(response, sky, _samples(400, seed=2))
    # smeared to a third and less at the longest baselines
    assert error < 3e-3
    assert terms <= 20


def test_a_band_without_probes_asks_all_of_them():
    sky = _sky([-0.7, 0.2, 1.0])
    response = Response.from_sky(sky, _samples(300))
    assert len(response.shared_factors(sky, 1e9, 2e9).chosen) == len(
        response.shared_factors(sky, 0, np.inf).chosen
    )


def test_strengths_are_what_is_left_of_a_flux():
    sky = _sky([-0.7, -0.7, 0.2], l=0.008)
    probes = _samples(3000)
    response = Response.from_sky(sky, probes, AiryBeam.from_diameters(np.array([13.5])))
    weight = probes.weights * response.gain(probes.frequency) ** 2
    for source, strength in enumerate(response.strengths(sky)):
        factor = _factor(response, probes, sky, source) / response.gain(probes.frequency)
        assert strength == pytest.approx(np.sqrt(np.average(factor**2, weights=weight)), rel=1e-5)
    bare = Response.from_sky(sky, probes)
    np.testing.assert_allclose(
        response.attenuations(sky), response.strengths(sky) / bare.strengths(sky)
    )
    aside = response.matched_filter(probes, *seen_as(sky, 0))
    assert np.average(aside**2, weights=weight) == pytest.approx(1.0, rel=1e-4)


def test_columns_that_repeat_are_chosen_once():
    factors = np.ones((30, 5)) * np.array([1.0, 2.0, 0.5, 1.0, 3.0])
    shared = SharedFactors.from_factors(factors)
    assert shared.chosen.tolist() == [4]
    np.testing.assert_allclose(shared.coefficients[0], [1 / 3, 2 / 3, 1 / 6, 1 / 3, 1.0])


@pytest.mark.parametrize("power", [1, 2])
def test_a_few_filters_make_those_of_a_tile(power):
    """On samples that chose nothing, as an rms relative to the filter."""
    rng = np.random.default_rng(3)
    sky = galaxies(
        np.radians(0.3 + rng.uniform(-0.12, 0.12, 60)),
        np.radians(-0.2 + rng.uniform(-0.12, 0.12, 60)),
        1.0,
        beta=rng.uniform(-1.2, 0.2, 60),
    )
    response = Response.from_sky(sky, _samples(2000), EVERYTHING)
    others = _samples(800, seed=2)
    filters = np.stack([response.matched_filter(others, *seen_as(sky, k)) for k in range(len(sky))])
    shared = response.shared_filters(sky, 0.0, np.inf, power)
    mixed = shared.coefficients.T @ filters[shared.chosen] ** power
    weight = others.weights * response.gain(others.frequency) ** 2
    error = np.sqrt(np.average((mixed - filters**power) ** 2, axis=1, weights=weight))
    assert error.max() < 3 * FILTER_TOLERANCE
    assert len(shared.chosen) <= 20
    # one filter for all is wrong by a quarter
    alone = filters[shared.chosen[:1]] ** power - filters**power
    assert np.sqrt(np.mean(alone**2)) > 20 * error.max()


def test_many_samples_are_combined_before_sources_are_chosen():
    rng = np.random.default_rng(5)
    factors = rng.standard_normal((3000, 4)) @ rng.standard_normal((4, 500))
    shared = SharedFactors.from_factors(factors)
    assert len(shared.chosen) == 4
    np.testing.assert_allclose(
        factors[:, shared.chosen] @ shared.coefficients, factors, atol=1e-9 * np.abs(factors).max()
    )
