"""The likelihood times the prior of size and flux, its moments, and what the lens makes of them."""

import numpy as np
import pytest

from tests.estimators.test_evidence import POPULATION, Toy
from uvshear.estimators.shape_integral import WeightedLattice
from uvshear.geometry.ellipticity import add_shear


def _long_toy(e, about=0j):
    """A likelihood that is three times as long along e1 as across."""
    likelihood = Toy(e, 0.01, size=0.0, slope=0.0).on_lattice()
    axes = likelihood.axes * [[3.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]]
    stretched = type(likelihood)(
        likelihood.point,
        likelihood.origin,
        axes,
        likelihood.log_likelihood,
        likelihood.flux,
        likelihood.flux_variance,
    )
    return WeightedLattice.weighted(stretched, POPULATION, about)


def test_the_mean_and_the_covariance_are_those_of_the_likelihood():
    lattice = _long_toy(0.3 - 0.2j)
    assert lattice.mean == pytest.approx(0.3 - 0.2j, abs=1e-4)
    # the lattice ends where the likelihood is exp(-10), which takes half a per cent of the width
    np.testing.assert_allclose(lattice.covariance, np.diag([9e-4, 1e-4]), rtol=0.02, atol=1e-6)
    assert lattice.extremes == pytest.approx((0.01, 0.03), rel=0.01)


def test_deviations_are_those_along_the_radius_and_across():
    assert _long_toy(0.5 + 0j).deviations() == pytest.approx((0.03, 0.01), rel=0.01)
    assert _long_toy(0.5j).deviations() == pytest.approx((0.01, 0.03), rel=0.01)


def test_the_lens_stretches_the_deviations_as_it_does_ellipticities():
    about = 0.2 - 0.1j
    lattice = _long_toy(0.4 + 0.3j, about)
    rng = np.random.default_rng(2)
    e = 0.4 + 0.3j + 0.03 * rng.normal(size=40_000) + 0.01j * rng.normal(size=40_000)
    away = (add_shear(e, -about) - lattice.unlensed_mean) / lattice.unlensed_mean
    away *= abs(lattice.unlensed_mean)
    expected = np.std(away.real), np.std(away.imag)
    # the lens is not linear over the width of the likelihood
    assert lattice.deviations() == pytest.approx(expected, rel=0.03)
    assert _long_toy(0.4 + 0.3j).deviations()[0] > 1.2 * expected[0]


def test_a_population_without_such_fluxes_has_no_such_galaxy():
    bright = POPULATION.flux.__class__(minimum=1e-3, maximum=2e-3)
    other = type(POPULATION)(bright, POPULATION.size, POPULATION.ellipticity)
    assert WeightedLattice.weighted(Toy(0.2j, 0.05).on_lattice(), other, 0j) is None
