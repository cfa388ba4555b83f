"""Ratios of sums, and their standard errors."""

import numpy as np
import pytest

from uvshear.estimators.terms import Terms
from uvshear.estimators.uncertainty import Bootstrap, Jackknife, jackknife_error, ratio


def _terms(g, number, rng, about=0j):
    """Values that respond to the shear by a matrix of their own, with scatter."""
    response = np.array([[1.5, 0.2], [0.2, 1.2]]) + 0.2 * rng.normal(size=(number, 2, 2))
    away = g - about
    signal = response @ np.array([away.real, away.imag])
    return Terms(signal + 0.3 * rng.normal(size=(number, 2)), response)


@pytest.mark.parametrize("about", [0j, 0.02 - 0.01j])
def test_the_ratio_is_the_shear_within_its_error(about):
    rng = np.random.default_rng(1)
    terms = _terms(0.03 - 0.05j, 20_000, rng, about)
    found, error = ratio(terms), Jackknife().error(terms)
    assert abs(found[0] + about.real - 0.03) < 4 * error[0]
    assert abs(found[1] + about.imag + 0.05) < 4 * error[1]
    # 0.3/1.5 and 0.3/1.2 over the root of the number
    assert error[0] == pytest.approx(0.3 / 1.5 / 20_000**0.5, rel=0.3)


@pytest.mark.parametrize("uncertainty", [Jackknife(), Bootstrap(resamples=300)])
def test_the_error_is_the_scatter_of_repetitions(uncertainty):
    rng = np.random.default_rng(2)
    repeated = [_terms(0.02 + 0j, 300, rng) for _ in range(200)]
    scatter = np.std([ratio(terms) for terms in repeated], axis=0)
    errors = np.mean([uncertainty.error(terms) for terms in repeated], axis=0)
    np.testing.assert_allclose(errors, scatter, rtol=0.2)


def test_the_jackknife_leaves_out_one_block_after_the_other():
    terms = _terms(0.02 + 0j, 10, np.random.default_rng(3))
    left = np.stack([ratio(terms.select(np.arange(10) % 5 != k)) for k in range(5)])
    np.testing.assert_allclose(Jackknife(blocks=5).error(terms), jackknife_error(left), rtol=1e-12)


def test_the_jackknifes_error_of_a_mean_is_that_of_the_mean():
    values = np.random.default_rng(4).normal(size=(50, 2))
    left = (values.sum(axis=0) - values) / 49
    expected = values.std(axis=0, ddof=1) / 50**0.5
    np.testing.assert_allclose(jackknife_error(left), expected, rtol=1e-12)


def test_the_bootstrap_draws_sources_with_replacement():
    terms = _terms(0.02 + 0j, 40, np.random.default_rng(5))
    rng = np.random.default_rng(7)
    drawn = [ratio(terms.select(rng.integers(40, size=40))) for _ in range(20)]
    found = Bootstrap(resamples=20, seed=7).error(terms)
    np.testing.assert_allclose(found, np.std(drawn, axis=0, ddof=1), rtol=1e-10)
