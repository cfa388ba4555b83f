"""A population fitted to the galaxies that it sends."""

from dataclasses import replace

import numpy as np
import pytest

from tests.estimators.test_evidence import FLUX, POPULATION, Toy
from uvshear.errors import InputError
from uvshear.estimators.evidence import evidence_and_gradient
from uvshear.estimators.population_fit import (
    LIKENESS,
    FittedPopulation,
    fit_population,
    moved,
)
from uvshear.galaxy import DiscEllipticityPrior, FlatEllipticityPrior, SizeFluxRelation
from uvshear.geometry.ellipticity import add_shear
from uvshear.progress import Meter

TRUE = replace(
    POPULATION,
    size=SizeFluxRelation(intercept=-0.78, sigma=0.4),
    ellipticity=DiscEllipticityPrior(c=0.35, e0=0.12),
)


def toy_likelihoods(number, rng, g=0.02 + 0j):
    """Galaxies of the true population behind a shear, with noise in shape and size."""
    modulus = TRUE.ellipticity.draw_modulus(number, rng)
    e = add_shear(modulus * np.exp(2j * np.pi * rng.uniform(size=number)), g)
    sigma, size_sigma = 0.12, 0.2
    e = e + sigma * (rng.normal(size=number) + 1j * rng.normal(size=number))
    median = POPULATION.size.log_median(np.array([FLUX]))[0]
    size = TRUE.size.log_median(np.full(number, FLUX)) + TRUE.size.sigma * rng.normal(size=number)
    size += size_sigma * rng.normal(size=number)
    return [
        Toy(complex(a), sigma, size=float(b - median), size_sigma=size_sigma, slope=0).on_lattice()
        for a, b in zip(e, size, strict=True)
    ]


def _behind(likelihoods, g=0.02 + 0j):
    return [(likelihood, g) for likelihood in likelihoods]


@pytest.fixture(scope="module")
def fitted():
    likelihoods = toy_likelihoods(150, np.random.default_rng(4))
    return likelihoods, fit_population(_behind(likelihoods), POPULATION)


def test_the_population_is_found_within_its_errors(fitted):
    _, found = fitted
    error = np.sqrt(np.diag(found.covariance))
    size, ellipticity = found.population.size, found.population.ellipticity
    got = np.array([size.intercept, *np.log([size.sigma, ellipticity.c, ellipticity.e0])])
    true = np.array([-0.78, *np.log([0.4, 0.35, 0.12])])
    assert np.all(np.abs(got - true) < 3 * error)
    # 0.45 over the root of 150 galaxies: the start is four errors away
    assert error[0] == pytest.approx(0.45 / 150**0.5, rel=0.2)
    assert abs(POPULATION.size.intercept + 0.78) > 3 * error[0]


def test_no_step_leads_to_a_more_probable_population(fitted):
    likelihoods, found = fitted
    error = np.sqrt(np.diag(found.covariance))

    def total(population):
        return sum(evidence_and_gradient(each, population, 0.02 + 0j)[0] for each in likelihoods)

    best = total(found.population)
    for k in range(4):
        for sign in (1, -1):
            step = np.zeros(4)
            step[k] = sign * error[k]
            assert total(moved(found.population, step)) < best


def test_what_few_galaxies_do_not_tell_stays_near_the_first_guess():
    """Of sixty of them the likelihood alone has no maximum: a scale of the ellipticities runs away."""
    likelihoods = toy_likelihoods(60, np.random.default_rng(8))
    found = fit_population(_behind(likelihoods), POPULATION)
    error = np.sqrt(np.diag(found.covariance))
    assert np.all(error < LIKENESS)
    assert error[3] > 0.5
    assert abs(np.log(found.population.ellipticity.e0 / POPULATION.ellipticity.e0)) < 2


def test_the_meter_counts_galaxies():
    likelihoods, told = toy_likelihoods(40, np.random.default_rng(4)), []
    meter = Meter(lambda done, total: told.append((done, total)))
    fit_population(_behind(likelihoods), POPULATION, meter)
    done, total = zip(*told, strict=True)
    assert len(done) % 40 == 0
    assert done == tuple(range(1, len(done) + 1))
    assert total[0] == 6 * 40


def test_few_galaxies_are_no_population():
    likelihoods = toy_likelihoods(5, np.random.default_rng(4))
    with pytest.raises(InputError, match="40 or more"):
        fit_population(_behind(likelihoods), POPULATION)


def test_the_record_has_the_errors_of_what_was_fitted():
    covariance = np.diag([0.02, 0.05, 0.1, 0.2]) ** 2
    record = FittedPopulation(TRUE, covariance).record()
    assert record["size"]["intercept_err"] == pytest.approx(0.02)
    assert record["size"]["sigma_err"] == pytest.approx(0.05 * 0.4)
    assert record["ellipticity"]["c_err"] == pytest.approx(0.1 * 0.35)
    assert record["ellipticity"]["e0_err"] == pytest.approx(0.2 * 0.12)


def test_ellipticities_of_another_kind_stay_and_have_no_errors():
    flat = replace(TRUE, ellipticity=FlatEllipticityPrior())
    fitted = FittedPopulation(flat, np.eye(2)).record()
    assert set(fitted) == {"flux", "size"}
    assert set(fitted["size"]) == {"intercept", "slope", "sigma", "intercept_err", "sigma_err"}
    assert moved(flat, np.array([0.1, 0.2])).ellipticity is flat.ellipticity


def test_each_galaxy_is_behind_a_shear_of_its_own():
    """In the frame of (l, m) one shear of the sky differs from source to source."""
    rng = np.random.default_rng(4)
    halves = [toy_likelihoods(30, rng, g) for g in (0.15 + 0j, -0.15 + 0j)]
    right = [*_behind(halves[0], 0.15 + 0j), *_behind(halves[1], -0.15 + 0j)]
    wrong = [(likelihood, -g) for likelihood, g in right]

    def probability(pairs):
        return sum(evidence_and_gradient(each, TRUE, g)[0] for each, g in pairs)

    assert probability(right) > probability(wrong)
    right, wrong = (fit_population(pairs, POPULATION).population for pairs in (right, wrong))
    # galaxies behind a shear of the wrong sign seem to be rounder or more elliptical than they are
    assert abs(right.ellipticity.e0 / wrong.ellipticity.e0 - 1) > 0.1
