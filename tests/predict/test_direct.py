"""The direct sum against sums over the sky, and against ducc0."""

from dataclasses import dataclass

import ducc0
import numpy as np
import pytest

from tests.reference import direct_sum
from tests.skies import L_BAND, galaxies, random_baselines, vla
from uvshear.constants import ARCSEC
from uvshear.execution import in_threads
from uvshear.galaxy import Exponential, Gaussian, Profile
from uvshear.predict import predict_visibilities
from uvshear.predict.direct import SLAB, predict_multiples

PROFILES = {"exponential": Exponential(), "gaussian": Gaussian()}
FAR = np.radians(0.5)


def test_point_sources_are_the_measurement_equation():
    rng = np.random.default_rng(2)
    l, m = rng.uniform(-0.012, 0.012, (2, 5))
    flux = rng.uniform(1, 3, 5)
    uvw, _ = vla("a", samples=1)
    frequency = np.array([1.3e9, 1.4e9])
    sky = galaxies(l, m, flux, alpha=0.0, beta=0.0)
    expected = direct_sum.point_sources(l, m, flux, uvw, frequency)
    # measured 2e-11: 1e4 turns in float64, in numpy and here; the sign of w: 1
    np.testing.assert_allclose(
        predict_visibilities(sky, uvw, frequency), expected, rtol=0, atol=1e-10
    )


@pytest.mark.parametrize("kind", PROFILES)
@pytest.mark.parametrize("e", [0j, 0.3 - 0.2j, -0.6 + 0.4j])
def test_a_galaxy_at_the_phase_centre_is_the_transform_of_its_brightness(kind, e):
    uvw = random_baselines(24, 4e3, depth=0)
    sky = galaxies(flux=2.0, alpha=4 * ARCSEC, e=e)
    expected = direct_sum.galaxy(0, 0, 2.0, e, 4 * ARCSEC, uvw, L_BAND, kind)
    got = predict_visibilities(sky, uvw, L_BAND, PROFILES[kind])
    # measured 5e-14: without w the phase is linear and the envelope exact. The sign of e2: 0.5
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize("kind", PROFILES)
def test_w_shifts_the_baseline_in_the_envelope_of_a_galaxy_off_centre(kind):
    e, alpha, l, m = 0.3 + 0.4j, 4 * ARCSEC, 0.8 * FAR, -0.6 * FAR
    uvw = random_baselines(24, 4e3, depth=1.0)
    expected = direct_sum.galaxy(l, m, 1.0, e, alpha, uvw, L_BAND, kind)
    got = predict_visibilities(galaxies(l, m, alpha=alpha, e=e), uvw, L_BAND, PROFILES[kind])
    second_order = 2 * np.pi * np.abs(uvw[:, 2]).max() * L_BAND[0] / 3e8 * (alpha / 0.5) ** 2
    # measured 2.1e-4: the next order, w x^2/2. Without the shift, or with its sign wrong: 8e-3 and more.
    assert np.abs(got - expected).max() < 3 * second_order < 1e-3
    unshifted = predict_visibilities(
        galaxies(alpha=alpha, e=e), uvw, L_BAND, PROFILES[kind]
    ) * direct_sum.point_sources(l, m, 1.0, uvw, L_BAND)
    assert np.abs(unshifted - expected).max() > 5e-3


@pytest.mark.parametrize("epsilon", [1e-4, 1e-7, 1e-10])
def test_ducc_agrees_to_its_epsilon_over_a_wide_field(epsilon):
    rng = np.random.default_rng(4)
    size, pixel = 64, 2 * np.radians(0.7) / 64
    i, j = rng.integers(0, size, (2, 12))
    image = np.zeros((size, size))
    np.add.at(image, (i, j), rng.uniform(0.5, 2, 12))
    uvw = random_baselines(1500, 1.5e3, depth=1.0)
    frequency = np.array([1.2e9, 1.6e9])
    i, j = np.nonzero(image)
    sky = galaxies((i - 32) * pixel, (j - 32) * pixel, image[i, j], alpha=0.0, beta=0.0)
    got = predict_visibilities(sky, uvw, frequency)
    expected = ducc0.wgridder.dirty2vis(
        uvw=uvw * (-1, -1, 1),
        freq=frequency,
        dirty=image,
        pixsize_x=pixel,
        pixsize_y=pixel,
        epsilon=epsilon,
        do_wgridding=True,
        divide_by_n=False,
    )
    error = np.linalg.norm(got - expected) / np.linalg.norm(expected)
    assert error < epsilon  # measured 3e-5, 3e-8, 2e-11; any sign wrong: 1


def test_the_flux_follows_the_spectral_index_from_the_reference_frequency():
    frequency = np.array([0.7e9, 1.4e9, 2.8e9])
    sky = galaxies(flux=[2.0, 3.0], alpha=0.0, beta=[-0.7, 1.0])
    vis = predict_visibilities(sky, np.zeros((1, 3)), frequency)
    expected = 2 * 2.0 ** np.array([0.7, 0, -0.7]) + 3 * np.array([0.5, 1, 2])
    np.testing.assert_allclose(vis[0], expected, rtol=1e-13)


def test_channels_are_what_each_would_be_alone():
    uvw, _ = vla(samples=1)
    frequency = np.array([1.2e9, 1.4e9, 1.9e9])
    sky = galaxies([0.003, -0.001], [0.001, 0.002], [1.0, 2.0], e=[0.3j, 0.5])
    together = predict_visibilities(sky, uvw, frequency)
    for chan in range(3):
        alone = predict_visibilities(sky, uvw, frequency[chan : chan + 1])
        np.testing.assert_array_equal(together[:, chan], alone[:, 0])


def test_a_galaxy_of_no_size_is_a_point_source_of_its_flux():
    uvw, _ = vla(samples=1)
    np.testing.assert_allclose(
        np.abs(predict_visibilities(galaxies(0.004, -0.002, 3.0, 0.0, 0.5j), uvw, L_BAND)),
        3.0,
        rtol=1e-12,
    )


@dataclass(frozen=True)
class Ring(Profile):
    """A profile of a user's own: any numpy expression of q."""

    def envelope(self, q):
        return np.cos(np.sqrt(q)) / (1 + q)


def test_a_profile_of_ones_own_is_predicted_by_its_envelope():
    uvw = random_baselines(50, 4e3, depth=0)
    alpha = 2 * ARCSEC
    vis = predict_visibilities(galaxies(flux=2.0, alpha=alpha), uvw, L_BAND, Ring())
    q = (2 * np.pi * alpha * np.hypot(uvw[:, 0], uvw[:, 1]) * L_BAND[0] / 299_792_458.0) ** 2
    np.testing.assert_allclose(vis[:, 0], 2 * np.cos(np.sqrt(q)) / (1 + q), rtol=0, atol=1e-12)


def test_threads_change_no_bit():
    uvw = random_baselines(2 * SLAB + 77, 5e3)
    sky = galaxies([0.002, -0.003, 0.001], [0.001, 0.004, -0.002], e=[0.3, 0.2j, -0.5])
    alone = predict_visibilities(sky, uvw, L_BAND, executor=in_threads(1))
    for threads in (2, 5):
        np.testing.assert_array_equal(
            predict_visibilities(sky, uvw, L_BAND, executor=in_threads(threads)), alone
        )


def test_the_order_of_sources_and_rows_does_not_matter():
    rng = np.random.default_rng(7)
    l, m = rng.uniform(-0.01, 0.01, (2, 9))
    uvw = random_baselines(300, 5e3)
    sky = galaxies(l, m, rng.uniform(1, 2, 9), e=0.4 * np.exp(1j * rng.uniform(0, 6, 9)))
    vis = predict_visibilities(sky, uvw, L_BAND)
    shuffled, rows = rng.permutation(9), rng.permutation(300)
    np.testing.assert_allclose(
        predict_visibilities(sky.select(shuffled), uvw[rows], L_BAND), vis[rows], rtol=0, atol=1e-12
    )


def test_an_empty_sky_has_no_visibilities():
    nothing = galaxies([0.0]).select(np.zeros(0, int))
    assert not predict_visibilities(nothing, random_baselines(5, 1e3), L_BAND).any()


def test_progress_is_told_of_the_visibilities_that_are_done():
    told = []
    uvw = random_baselines(SLAB + 100, 4e3)
    predict_visibilities(
        galaxies(), uvw, np.array([1.3e9, 1.4e9]), progress=lambda *work: told.append(work)
    )
    total = 2 * len(uvw)
    assert told == [(done, total) for done in (SLAB, 2 * SLAB, 2 * SLAB + 100, total)]


def test_sums_of_multiples_do_not_depend_on_the_order_of_the_galaxies():
    rng = np.random.default_rng(8)
    l, m = rng.uniform(-0.005, 0.005, (2, 37))
    sky = galaxies(l, m, rng.uniform(1e-5, 1e-4, 37), rng.uniform(0, 2, 37) * ARCSEC, 0.2j)
    uvw, _ = vla("a", samples=1)
    unit = 2.0**-60
    found = predict_multiples(sky, uvw, L_BAND, PROFILES["exponential"], unit)
    expected = predict_visibilities(sky, uvw, L_BAND)
    # 37 roundings by half a unit at most, in both parts
    assert np.abs(unit * found - expected).max() < 37 * unit
    assert np.array_equal(found.real, np.rint(found.real))
    order = rng.permutation(37)
    shuffled = predict_multiples(sky.select(order), uvw, L_BAND, PROFILES["exponential"], unit)
    np.testing.assert_array_equal(shuffled, found)
    part, rest = (sky.select(some) for some in (order[:20], order[20:]))
    without = found - predict_multiples(part, uvw, L_BAND, PROFILES["exponential"], unit)
    np.testing.assert_array_equal(
        without, predict_multiples(rest, uvw, L_BAND, PROFILES["exponential"], unit)
    )
