"""The Bayesian estimator: likelihoods kept, unpacked, and behind a population."""

from dataclasses import replace

import numpy as np
import pytest

from tests.estimators.facets import source_facet
from tests.estimators.test_evidence import POPULATION, Toy
from tests.estimators.test_population_fit import toy_likelihoods
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian, likelihoods_of
from uvshear.estimators.estimate import estimate_sample_shear
from uvshear.estimators.estimator import observe
from uvshear.estimators.evidence import gradient_and_curvature
from uvshear.estimators.packing import PACKED, pack
from uvshear.estimators.population_fit import fit_population
from uvshear.estimators.sample import Sample
from uvshear.galaxy import Gaussian, SizeFluxRelation
from uvshear.geometry.ellipticity import add_shear
from uvshear.shapes.statistic_flag import StatisticFlag


def _rings(g, number=25, seed=8):
    """Likelihoods of galaxies with e and -e, behind a shear of the frame of (l, m)."""
    rng = np.random.default_rng(seed)
    modulus = POPULATION.ellipticity.draw_modulus(number, rng)
    intrinsic = modulus * np.exp(2j * np.pi * rng.uniform(size=number))
    e = add_shear(np.concatenate([intrinsic, -intrinsic]), g)
    return [Toy(complex(each), 0.05, size=0.0).on_lattice() for each in e]


def _packed(likelihoods):
    rows = [pack(likelihood) for likelihood in likelihoods]
    return Sample.from_rows([{**row, "flux": 2e-5} for row in rows])


def test_the_shear_of_a_sample_is_found_in_the_frame_of_the_sky():
    found = estimate_sample_shear(Bayesian(), _packed(_rings(0.04 + 0.03j)))
    assert found.n == 50
    # the intrinsic shapes of rings cancel; a wrong sign or a wrong response would be seen at 0.03
    assert found.g1 == pytest.approx(0.04, abs=4e-3)
    assert found.g2 == pytest.approx(-0.03, abs=4e-3)
    assert found.assumed == {"prior": "paper", "population": POPULATION.record()}


def test_terms_are_gradient_and_curvature():
    likelihoods = _rings(0.02j, number=2)
    sample = Sample.from_rows([{"likelihood": likelihood} for likelihood in likelihoods])
    about = np.array([0.01 + 0j, 0.02j, 0j, 0.01j])
    terms = Bayesian().terms(sample, about)
    for k, likelihood in enumerate(likelihoods):
        q, h = gradient_and_curvature(likelihood, POPULATION, complex(about[k]))
        np.testing.assert_array_equal(terms.value[k], q)
        np.testing.assert_array_equal(terms.response[k], h)


def test_a_simulated_sample_has_the_likelihoods_that_are_kept_but_for_packing():
    source, bayesian = source_facet(noise=6.0), Bayesian()
    row = observe(bayesian, source)
    simulated = Sample.from_rows([row])
    kept = Sample.from_rows([bayesian.statistic(source)])
    assert set(kept.columns) == set(bayesian.columns) == set(PACKED)
    about = np.array([0.02 - 0.01j])
    ours, theirs = (bayesian.terms(sample, about) for sample in (simulated, kept))
    scale = np.sqrt(np.trace(ours.response[0]) / 2)
    np.testing.assert_allclose(theirs.value, ours.value, rtol=0, atol=3e-3 * scale)
    np.testing.assert_allclose(theirs.response, ours.response, rtol=0, atol=5e-3 * scale**2)


def test_a_source_without_a_likelihood_tells_nothing():
    sample = _packed(_rings(0j, number=2))
    empty = {name: np.zeros(0) for name in PACKED} | {"flux": 2e-5}
    rows = [{name: sample[name][k] for name in sample.columns} for k in range(4)]
    with_gap = Sample.from_rows([rows[0], empty, *rows[1:]])
    assert [likelihood is None for likelihood in likelihoods_of(with_gap)][:3] == [
        False,
        True,
        False,
    ]
    terms = Bayesian().terms(with_gap, np.zeros(5, complex))
    assert terms.tells.tolist() == [True, False, True, True, True]
    # a table in which no source has one holds numbers
    nobody = Sample({name: np.full(2, np.nan) for name in PACKED}, np.zeros(2))
    assert likelihoods_of(nobody) == [None, None]


def test_galaxies_that_the_population_does_not_have_are_no_shear():
    faint = replace(POPULATION, flux=replace(POPULATION.flux, minimum=1e-3, maximum=2e-3))
    with pytest.raises(InputError, match="of 4 selected galaxies, fewer than 2 contribute"):
        estimate_sample_shear(Bayesian(faint), _packed(_rings(0j, number=2)))


def test_the_likelihood_of_a_facet_peaks_near_its_galaxy():
    row = observe(Bayesian(), source_facet())
    likelihood = row["likelihood"]
    weight = np.exp(likelihood.log_likelihood - likelihood.log_likelihood.max())
    mean = np.average(likelihood.ellipticity, weights=weight)
    # the signal-to-noise ratio is about 50
    assert abs(mean - (0.3 - 0.1j)) < 0.05


def test_the_profile_is_that_of_the_source():
    """Each profile has its own decomposition of templates, made once."""
    bayesian, source = Bayesian(), source_facet(noise=6.0)
    for profile in (source.profile, Gaussian(), Gaussian()):
        bayesian.statistic(replace(source, profile=profile))
    assert set(bayesian._caches) == {source.profile, Gaussian()}


def test_a_facet_without_a_galaxy_has_no_statistic():
    source = source_facet(flux=-5e-5, noise=0.1)
    bayesian = Bayesian()
    assert bayesian.statistic(source) is StatisticFlag.NOT_FITTED
    assert bayesian.numbers(source) is None
    assert observe(bayesian, source) is None


def test_the_population_is_fitted_behind_the_shear_of_the_sample():
    """The sample's galaxies are larger than the paper's; likelihoods are in the frame of (l, m), the shear is not."""
    likelihoods = toy_likelihoods(60, np.random.default_rng(8), 0.02 + 0.05j)
    sample = _packed(likelihoods)
    learner = Bayesian(fits_population=True)
    assert learner.is_learning
    trained = learner.trained(sample, 0.02 - 0.05j)
    assert not trained.is_learning
    found = fit_population([(each, 0.02 + 0.05j) for each in likelihoods], POPULATION)
    got, expected = (fitted.population.size for fitted in (trained.fitted, found))
    assert got.intercept == pytest.approx(expected.intercept, abs=1e-3)
    assert trained.population == trained.fitted.population
    record = trained.record()
    assert record["prior"] == "fitted"
    size = record["population"]["size"]
    assert size["intercept"] == pytest.approx(-0.78, abs=3 * size["intercept_err"])


def test_the_origin_of_the_population_is_told():
    own = replace(POPULATION, size=SizeFluxRelation(sigma=0.2))
    assert Bayesian().prior == "paper"
    assert Bayesian(own).prior == "file"
    assert Bayesian(own, fits_population=True).prior == "fitted"
    assert Bayesian(own).record()["population"]["size"]["sigma"] == 0.2
