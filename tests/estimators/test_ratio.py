"""Ratios of sums, and their jackknife."""

import numpy as np
import pytest
from uvshear.estimators.ratio import Responses

from uvshear.errors import InputError
from uvshear.estimators.moments import moment_weight


def _responses(g, number, rng, about=0j):
    """Values that respond to the shear by a matrix of their own, with scatter."""
    response = np.array([[1.5, 0.2], [0.2, 1.2]]) + 0.2 * rng.normal(size=(number, 2, 2))
    away = g - about
    signal = response @ np.array([away.real, away.imag])
    return Responses(signal + 0.3 * rng.normal(size=(number, 2)), response, about)


@pytest.mark.parametrize("about", [0j, 0.02 - 0.01j])
def test_the_ratio_is_the_shear_within_its_error(about):
    rng = np.random.default_rng(1)
    got = _responses(0.03 - 0.05j, 20_000, rng, about).shear("moments")
    assert got.n == 20_000
    assert abs(got.g1 - 0.03) < 4 * got.g1_err
    assert abs(got.g2 + 0.05) < 4 * got.g2_err
    # 0.3/1.5 and 0.3/1.2 over the root of the number
    assert got.g1_err == pytest.approx(0.3 / 1.5 / 20_000**0.5, rel=0.3)


def test_the_jackknifes_error_is_the_scatter_of_repetitions():
    rng = np.random.default_rng(2)
    repeated = [_responses(0.02 + 0j, 300, rng).shear("x") for _ in range(200)]
    scatter = np.std([one.g1 for one in repeated])
    assert np.mean([one.g1_err for one in repeated]) == pytest.approx(scatter, rel=0.2)


def test_weights_count_galaxies():
    rng = np.random.default_rng(3)
    one = _responses(0.05 + 0j, 10, rng)
    twice = one.weighted(np.array([2.0] + [1.0] * 9))
    np.testing.assert_array_equal(twice.value[0], 2 * one.value[0])
    np.testing.assert_array_equal(twice.response[1:], one.response[1:])


def test_one_galaxy_is_no_shear():
    with pytest.raises(InputError, match="two or more"):
        Responses(np.zeros((1, 2)), np.zeros((1, 2, 2))).shear("moments")


def test_the_weight_is_flat_where_noise_is_nothing_and_falls_with_the_noise():
    flux = np.array([1e-5, 1e-4])
    np.testing.assert_allclose(moment_weight(flux, np.zeros(2)) * flux, 1 / (0.09 * 1.5))
    noisy = moment_weight(flux, np.full(2, 1e-8))
    np.testing.assert_allclose(noisy, 1.5 * flux / 1e-8, rtol=0.25)
