"""Ratios of sums, and their standard errors."""

import numpy as np
import pytest

from uvshear.estimators.terms import Terms
from uvshear.estimators.uncertainty import jackknife_error, ratio, ratio_error


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
    found, error = ratio(terms), ratio_error(terms)
    assert abs(found[0] + about.real - 0.03) < 4 * error[0]
    assert abs(found[1] + about.imag + 0.05) < 4 * error[1]
    # 0.3/1.5 and 0.3/1.2 over the root of the number
    assert error[0] == pytest.approx(0.3 / 1.5 / 20_000**0.5, rel=0.05)


def test_the_error_is_the_scatter_of_repetitions():
    """200 samples: the scatter of both components together is known to 3.5 per cent."""
    rng = np.random.default_rng(2)
    repeated = [_terms(0.02 + 0j, 300, rng) for _ in range(200)]
    scatter = np.std([ratio(terms) for terms in repeated], axis=0, ddof=1)
    errors = np.mean([ratio_error(terms) for terms in repeated], axis=0)
    assert np.sqrt(np.mean((scatter / errors) ** 2)) == pytest.approx(1, abs=0.07)


def test_sources_are_left_out_one_by_one():
    terms = _terms(0.02 + 0j, 10, np.random.default_rng(3))
    left = np.stack([ratio(terms.select(np.arange(10) != k)) for k in range(10)])
    np.testing.assert_allclose(ratio_error(terms), jackknife_error(left), rtol=1e-12)


def test_patches_are_left_out_one_after_the_other():
    terms = _terms(0.02 + 0j, 10, np.random.default_rng(3))
    patch = np.array([4, 1, 4, 7, 7, 1, 1, 4, 7, 4])
    left = np.stack([ratio(terms.select(patch != k)) for k in (1, 4, 7)])
    np.testing.assert_allclose(ratio_error(terms, patch), jackknife_error(left), rtol=1e-12)


def test_patches_show_what_their_sources_have_in_common():
    """Forty patches whose sources share a shear of their own, which hides in the errors of single sources."""
    rng = np.random.default_rng(8)
    patch = np.repeat(np.arange(40), 50)
    response = np.tile(np.eye(2), (2000, 1, 1))
    found = []
    for _ in range(100):
        common = 0.05 * rng.normal(size=(40, 2))
        terms = Terms(common[patch] + 0.2 * rng.normal(size=(2000, 2)), response)
        found.append([ratio(terms), ratio_error(terms), ratio_error(terms, patch)])
    shear, single, patched = np.array(found).swapaxes(0, 1)
    scatter = np.sqrt(np.mean(shear**2))
    assert np.sqrt(np.mean(patched**2)) == pytest.approx(scatter, rel=0.15)
    assert np.sqrt(np.mean(single**2)) < 0.6 * scatter


def test_the_order_of_the_sources_does_not_matter():
    rng = np.random.default_rng(9)
    terms = _terms(0.02 + 0j, 1090, rng)
    patch = rng.integers(20, size=1090)
    order = rng.permutation(1090)
    shuffled = terms.select(order)
    np.testing.assert_allclose(ratio_error(shuffled), ratio_error(terms), rtol=1e-10)
    np.testing.assert_allclose(
        ratio_error(shuffled, patch[order]), ratio_error(terms, patch), rtol=1e-10
    )


def test_the_jackknifes_error_of_a_mean_is_that_of_the_mean():
    values = np.random.default_rng(4).normal(size=(50, 2))
    left = (values.sum(axis=0) - values) / 49
    expected = values.std(axis=0, ddof=1) / 50**0.5
    np.testing.assert_allclose(jackknife_error(left), expected, rtol=1e-12)


def test_responses_that_cancel_have_no_ratio():
    terms = Terms(np.ones((2, 2)), np.stack([np.eye(2), -np.eye(2)]))
    assert np.isnan(ratio(terms)).all()
    assert np.isnan(ratio_error(terms.select(np.array([0, 1, 0])))).all()
