"""Tests of whether galaxies are those of the assumed population."""

from dataclasses import replace

import numpy as np
import pytest

from tests.estimators.test_evidence import FLUX, FLUX_SIGMA, POPULATION, Toy
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.estimate import estimate_sample_shear
from uvshear.estimators.goodness import PopulationGoodness
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.galaxy import DiscEllipticityPrior, FlatEllipticityPrior
from uvshear.geometry.ellipticity import add_shear

G = 0.02 + 0j


def _larger(factor):
    size = replace(POPULATION.size, intercept=POPULATION.size.intercept + float(np.log(factor)))
    return replace(POPULATION, size=size)


ROUND = replace(POPULATION, ellipticity=DiscEllipticityPrior(c=0.2, e0=0.02, maximum=0.5))


def _galaxies(population, number, sigma, seed):
    """Likelihoods of galaxies of a population, with noise in shape, size and flux."""
    rng = np.random.default_rng(seed)
    modulus = population.ellipticity.draw_modulus(number, rng)
    e = add_shear(modulus * np.exp(2j * np.pi * rng.uniform(size=number)), G)
    e = e + sigma * (rng.normal(size=number) + 1j * rng.normal(size=number))
    size_sigma = 1.5 * sigma
    flux = FLUX + FLUX_SIGMA * rng.normal(size=number)
    size = population.size.log_median(flux) - POPULATION.size.log_median(np.array([FLUX]))[0]
    size += population.size.sigma * rng.normal(size=number) + size_sigma * rng.normal(size=number)
    return [
        Toy(complex(a), sigma, size=float(b), size_sigma=size_sigma, slope=0).on_lattice()
        for a, b in zip(e, size, strict=True)
    ]


def _goodness(likelihoods, population=POPULATION):
    sample = Sample.from_rows([{"likelihood": likelihood} for likelihood in likelihoods])
    bayesian, about = Bayesian(population), np.full(len(sample), G)
    return PopulationGoodness.from_terms(
        bayesian.terms(sample, about), bayesian.scores(sample, about)
    )


@pytest.mark.parametrize(("number", "sigma"), [(30, 0.05), (120, 0.02), (320, 0.003)])
@pytest.mark.parametrize("seed", [1, 2])
def test_the_right_population_fits(number, sigma, seed):
    found = _goodness(_galaxies(POPULATION, number, sigma, seed))
    assert found.reasons == ()
    assert (found.n, found.absent) == (number, 0)
    # under the right population a probability below 1e-4 is one in ten thousand
    assert all(part.probability > 1e-4 for part in found.parts.values())
    assert found.parts.keys() == ({"size", "ellipticity"} if number >= 100 else set())


@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_sizes_that_are_a_fifth_off_are_told(factor):
    found = _goodness(_galaxies(_larger(factor), 200, 0.02, 3))
    size = found.parts["size"]
    # the scatter of 0.31 over the root of 200 galaxies
    assert size.shift["median"] == pytest.approx(np.log(factor), abs=3 * 0.022)
    (reason,) = found.reasons
    times = float(reason.removeprefix("their sizes are about ").split()[0])
    assert times == pytest.approx(factor, abs=0.08)


def test_a_deviation_that_does_not_matter_is_not_told():
    """Sizes that are 4 per cent off: significant in a survey, but the shear is right."""
    scores = np.random.default_rng(2).normal(size=(100_000, 4)) * 3 + 9 * 0.04 * np.eye(4)[0]
    terms = Terms(np.ones((100_000, 2)), np.tile(np.eye(2), (100_000, 1, 1)))
    found = PopulationGoodness.from_terms(terms, scores)
    assert found.parts["size"].probability < 1e-100
    assert found.parts["size"].shift["median"] == pytest.approx(0.04, abs=0.004)
    assert found.reasons == ()


def test_other_ellipticities_are_told():
    found = _goodness(_galaxies(ROUND, 120, 0.05, 4))
    assert found.reasons == ("their ellipticities have a different distribution",)


def test_a_catalogue_half_of_which_are_points_is_told():
    """The likelihood of a point has all ellipticities, and sizes far below those of the population."""
    rng = np.random.default_rng(6)
    e = 0.2 * (rng.normal(size=60) + 1j * rng.normal(size=60))
    points = [Toy(complex(each), 0.25, size=-1.5, size_sigma=0.5).on_lattice() for each in e]
    found = _goodness(_galaxies(POPULATION, 60, 0.05, 6) + points)
    assert any(reason.startswith("their sizes are about 0.") for reason in found.reasons)


def test_galaxies_that_do_not_occur_are_counted_and_told():
    galaxies = _galaxies(POPULATION, 30, 0.05, 7)
    bright = [replace(each, flux=each.flux * 100) for each in galaxies]
    found = _goodness([*galaxies[:24], *bright[24:]])
    assert (found.n, found.absent) == (30, 6)
    assert found.reasons == ("6 of 30 galaxies cannot belong to it",)
    assert _goodness([*galaxies[:29], bright[29]]).reasons == ()


def test_a_curvature_that_does_not_belong_to_the_gradients_is_told():
    """For a fitted population, which has no scores."""
    value = np.random.default_rng(1).normal(size=(400, 2))
    none = np.zeros((400, 0))
    right = Terms(value, np.tile(np.eye(2), (400, 1, 1)))
    wrong = Terms(1.5 * value, right.response)
    assert PopulationGoodness.from_terms(right, none).reasons == ()
    found = PopulationGoodness.from_terms(wrong, none)
    assert found.information_ratio == pytest.approx(2.25, rel=0.15)
    (reason,) = found.reasons
    assert "information ratio 2." in reason
    assert found.parts == {}


def test_sources_without_a_likelihood_are_not_counted():
    value = np.array([[1.0, 0.0], [np.nan, np.nan], [0.0, 0.0]])
    response = np.array([np.eye(2), np.full((2, 2), np.nan), np.zeros((2, 2))])
    found = PopulationGoodness.from_terms(Terms(value, response), np.zeros((3, 0)))
    assert (found.n, found.absent) == (2, 1)


def test_the_record_has_every_number():
    record = _goodness(_galaxies(_larger(1.0), 100, 0.02, 3)).record()
    assert set(record["size"]) == {"probability", "median_log_shift", "sigma_log_shift"}
    assert set(record["ellipticity"]) == {"probability", "c_log_shift", "e0_log_shift"}
    numbers = {"n", "absent", "information_ratio", "information_probability"}
    assert record.keys() - numbers == {"size", "ellipticity"}


def test_a_prior_of_another_kind_is_tested_by_its_sizes():
    flat = replace(POPULATION, ellipticity=FlatEllipticityPrior(0.8))
    found = _goodness(_galaxies(flat, 100, 0.02, 9), flat)
    assert found.parts.keys() == {"size"}
    assert found.reasons == ()


def test_an_estimate_tells_what_to_do():
    """The shear of galaxies that are half as large as the paper's; with the right sizes nothing is said."""
    sample = Sample.from_rows(
        [{"likelihood": each} for each in _galaxies(_larger(0.5), 110, 0.02, 5)]
    )
    (remark,) = estimate_sample_shear(Bayesian(), sample).remarks
    assert remark.startswith(
        "the assumed population (paper) does not fit these galaxies: their sizes"
    )
    assert "use --prior fitted, --prior FILE or --estimator moments" in remark
    right = estimate_sample_shear(Bayesian(_larger(0.5)), sample)
    assert right.remarks == ()
    assert right.goodness.n == 110
