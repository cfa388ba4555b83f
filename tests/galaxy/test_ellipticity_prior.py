from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from uvshear.errors import InputError
from uvshear.galaxy import DiscEllipticityPrior, FlatEllipticityPrior

PRIORS = [FlatEllipticityPrior(), FlatEllipticityPrior(0.5), DiscEllipticityPrior()]
EACH = pytest.mark.parametrize("prior", PRIORS, ids=repr)


def papers_density(e, maximum=0.804, c=0.2298, e0=0.0732):
    return e * (1 - np.exp((e - maximum) / c)) / ((1 + e) * np.sqrt(e**2 + e0**2))


@EACH
def test_density_over_the_plane_is_one(prior):
    side = np.linspace(-1, 1, 1601)
    e = side[:, None] + 1j * side
    total = np.exp(prior.log_density(e)).sum() * (side[1] - side[0]) ** 2
    assert total == pytest.approx(1, abs=2e-3)  # measured 1.1e-3, the disc's edge on the grid


@EACH
def test_density_is_isotropic_and_minus_infinity_outside(prior):
    e = 0.4 * np.exp(1j * np.linspace(0, 6, 13))
    assert np.ptp(prior.log_density(e)) < 1e-12
    outside = np.array([prior.maximum, prior.maximum + 0.01, 3.0]) * np.exp(0.3j)
    assert np.all(prior.log_density(outside * (1 + 1e-12)) == -np.inf)
    assert np.all(prior.modulus_density(np.abs(outside) * (1 + 1e-12)) == 0)


@EACH
def test_modulus_density_is_the_ring_of_the_plane_density(prior):
    r = np.linspace(0.01, 0.49, 20)
    np.testing.assert_allclose(
        prior.modulus_density(r), 2 * np.pi * r * np.exp(prior.log_density(r + 0j)), rtol=1e-12
    )


def test_flat_prior_is_one_over_the_disc():
    prior = FlatEllipticityPrior()
    np.testing.assert_allclose(
        prior.log_density(np.array([0j, 0.9j])), -np.log(np.pi * 0.95**2), atol=1e-9
    )
    assert prior.population_variance == pytest.approx(0.95**2 / 4, rel=1e-6)


def test_disc_prior_is_the_papers_function_normalised():
    r = np.linspace(0.001, 0.8, 30)
    normalisation = 1 / quad(papers_density, 0, 0.804, epsabs=1e-13)[0]
    np.testing.assert_allclose(
        DiscEllipticityPrior().modulus_density(r), normalisation * papers_density(r), rtol=1e-7
    )


def test_the_papers_normalisation_belongs_to_a_maximum_of_0_8():
    at_0_804 = 1 / quad(papers_density, 0, 0.804)[0]
    at_0_8 = 1 / quad(papers_density, 0, 0.8, args=(0.8,))[0]
    assert at_0_804 == pytest.approx(2.5784, abs=1e-4)
    assert at_0_8 == pytest.approx(2.595, abs=1e-3)


@EACH
def test_drawn_moduli_follow_the_density(prior):
    number = 200_000
    r = prior.draw_modulus(number, np.random.default_rng(7))
    edges = np.linspace(0, prior.maximum, 21)
    expected = [
        number * quad(lambda x: float(prior.modulus_density(np.array([x]))[0]), a, b)[0]
        for a, b in pairwise(edges)
    ]
    counts = np.histogram(r, edges)[0]
    assert counts.sum() == number
    chi2 = np.sum((counts - expected) ** 2 / np.array(expected))
    assert 5 < chi2 < 45  # 19 degrees of freedom


@EACH
def test_population_variance_is_that_of_the_draws(prior):
    number = 200_000
    half = prior.draw_modulus(number, np.random.default_rng(8)) ** 2 / 2
    error = half.std() / np.sqrt(number)
    assert abs(half.mean() - prior.population_variance) < 3 * error
    assert error < 0.003 * prior.population_variance


def test_population_variance_of_the_paper():
    assert DiscEllipticityPrior().population_variance == pytest.approx(0.07233, abs=1e-5)


@pytest.mark.parametrize("maximum", [0.0, 1.0, -0.1])
def test_a_maximum_outside_the_disc_is_refused(maximum):
    with pytest.raises(InputError, match="between 0 and 1"):
        FlatEllipticityPrior(maximum)
    with pytest.raises(InputError, match="between 0 and 1"):
        DiscEllipticityPrior(maximum=maximum)
