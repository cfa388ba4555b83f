"""The sum over the lattice, where the population is smooth."""

import numpy as np
import pytest

from tests.estimators.test_evidence import POPULATION, Toy
from uvshear.estimators.lattice_integral import LatticeIntegral, is_clear
from uvshear.estimators.polar_integral import PolarIntegral
from uvshear.estimators.shape_integral import WeightedLattice

DISC = POPULATION.ellipticity


def _lattice(e, sigma, about=0j):
    return WeightedLattice.weighted(Toy(e, sigma).on_lattice(), POPULATION, about)


@pytest.mark.parametrize(
    ("e", "expected"), [(0.4j, True), (-0.2 + 0j, False), (0.05 + 0j, False), (0.65j, False)]
)
def test_a_likelihood_is_clear_of_the_centre_and_of_the_rim(e, expected):
    assert is_clear(_lattice(e, 0.045), DISC.maximum) is expected


@pytest.mark.parametrize("g", [0.03 - 0.02j, 0.05 + 0j])
def test_the_lattice_and_polar_nodes_give_the_same_sum(g):
    """They share no node; a wrong area or a lost factor r^2 would be 10 per cent."""
    about = 0.03 - 0.02j
    lattice = _lattice(0.3 - 0.3j, 0.05, about)
    ours, theirs = LatticeIntegral(lattice), PolarIntegral(lattice, DISC.maximum)
    assert ours.terms(DISC, g).sum() == pytest.approx(theirs.terms(DISC, g).sum(), rel=3e-4)


def test_the_weight_is_the_density_of_lensed_ellipticities():
    """Its integral over all of them is one, whatever the shear."""
    integral = LatticeIntegral(_lattice(0.4j, 0.03))
    x = np.arange(-0.95, 0.95, 0.002) + 0.0003
    e = (x[:, None] + 1j * x).ravel()
    integral._e = e[np.abs(e) < 0.95]
    assert 0.002**2 * integral.weight(DISC, 0.1 - 0.05j).sum() == pytest.approx(1, abs=1e-3)
