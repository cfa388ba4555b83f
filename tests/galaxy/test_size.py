import numpy as np
import pytest
from scipy.stats import lognorm

from uvshear.constants import ARCSEC
from uvshear.galaxy import SizeFluxRelation, SizePrior


def test_median_is_the_papers_relation():
    flux = np.array([10e-6, 200e-6])
    # 0.84 and 2.27 arcseconds
    expected = np.exp(-0.93) * np.array([10, 200]) ** 0.33
    np.testing.assert_allclose(SizeFluxRelation().median(flux) / ARCSEC, expected, rtol=1e-12)
    np.testing.assert_allclose(
        np.exp(SizeFluxRelation().log_median(flux)), SizeFluxRelation().median(flux)
    )


def test_drawn_sizes_are_lognormal_about_the_median():
    number, relation = 100_000, SizeFluxRelation()
    flux = np.random.default_rng(1).uniform(10e-6, 200e-6, number)
    scatter = np.log(relation.draw(flux, np.random.default_rng(2)) / relation.median(flux))
    assert abs(scatter.mean()) < 3 * relation.sigma / np.sqrt(number)
    assert abs(scatter.std() / relation.sigma - 1) < 3 / np.sqrt(2 * number)
    assert 3 / np.sqrt(2 * number) < 0.01


def test_size_prior_is_scipys_lognormal():
    prior = SizePrior(np.log([1e-6, 5e-6]), np.array([0.3, 0.5]))
    scale_length = np.array([[1e-6, 2e-6], [3e-6, 4e-6]])
    expected = lognorm.logpdf(scale_length, [0.3, 0.5], scale=[1e-6, 5e-6])
    np.testing.assert_allclose(prior.log_density(scale_length), expected, rtol=1e-12)


def test_relation_and_selection_give_the_prior_of_each_source():
    flux = np.array([10e-6, 50e-6, 200e-6])
    prior = SizeFluxRelation().prior(flux)
    assert len(prior) == 3
    chosen = prior.select(np.array([2, 0]))
    np.testing.assert_array_equal(chosen.log_median, prior.log_median[[2, 0]])
    assert chosen.sigma == pytest.approx([0.3136, 0.3136])
