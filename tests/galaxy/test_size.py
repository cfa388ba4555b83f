import numpy as np
import pytest
from scipy.stats import lognorm

from uvshear.constants import ARCSEC
from uvshear.galaxy import CatalogueSize, SizeFluxRelation, SizePrior
from uvshear.galaxy.size import UNKNOWN_SIGMA


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


def test_the_prior_about_a_catalogue_s_size_widens_with_its_error():
    size, flux = np.array([1.0, 2.0, 3.0]) * ARCSEC, np.full(3, 1e-4)
    without = CatalogueSize(0.3).prior(flux, size)
    np.testing.assert_allclose(without.log_median, np.log(size))
    np.testing.assert_allclose(without.sigma, 0.3)
    prior = CatalogueSize(0.3).prior(flux, size, np.array([0.0, 0.2, 6.0]) * ARCSEC)
    np.testing.assert_allclose(prior.log_median, np.log(size))
    np.testing.assert_allclose(prior.sigma**2, 0.09 + np.log([1.0, 1.01, 5.0]))
    # A lognormal distribution of this width has the relative standard deviation of the error.
    assert lognorm.std(np.sqrt(np.log(5.0)), scale=1.0) == pytest.approx(
        2.0 * lognorm.mean(np.sqrt(np.log(5.0)), scale=1.0)
    )


def test_a_size_that_is_not_known_follows_from_the_flux_with_a_wide_prior():
    flux = np.array([1e-5, 1e-4])
    prior = CatalogueSize(0.3).prior(flux, np.array([np.nan, 1e-5]), np.zeros(2))
    assert prior.log_median[0] == SizeFluxRelation().log_median(flux)[0]
    np.testing.assert_allclose(prior.sigma**2, [0.09 + UNKNOWN_SIGMA**2, 0.09])
