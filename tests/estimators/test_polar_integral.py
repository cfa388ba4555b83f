"""The sum over polar nodes where the population has its core, its kink or its rim."""

import numpy as np
import pytest

from tests.estimators.test_evidence import POPULATION, Toy
from uvshear.estimators.polar_integral import PolarIntegral
from uvshear.estimators.shape_integral import WeightedLattice
from uvshear.geometry.ellipticity import add_shear

DISC = POPULATION.ellipticity


def _lattice(e, sigma):
    return WeightedLattice.weighted(Toy(e, sigma, size_sigma=0.02).on_lattice(), POPULATION, 0j)


def _evidence(lattice, sigma, g, half=8, count=501):
    """Sum over a fine grid of the observed e, with a Gaussian likelihood."""
    x = np.linspace(-half, half, count) * sigma
    e = lattice.mean + (x[:, None] + 1j * x).ravel()
    density = np.exp(DISC.log_density(add_shear(e, -g)))
    r = (1 - abs(g) ** 2) / np.abs(1 - np.conj(g) * e) ** 2
    likelihood = np.exp(-0.5 * np.abs((e - lattice.mean) / sigma) ** 2)
    return np.sum(density * r**2 * likelihood) * (x[1] - x[0]) ** 2


@pytest.mark.parametrize("e", [0.002 + 0.001j, 0.03j, 0.5 - 0.62j])
def test_the_evidence_near_kinks_is_that_of_a_fine_grid(e):
    """Near the centre, where nodes go around it, and at the rim, beyond which there is nothing."""
    sigma, shears = 0.005, (0j, 0.004 + 0.002j, -0.003 + 0.004j)
    lattice = _lattice(e, sigma)
    integral = PolarIntegral(lattice, DISC.maximum)
    ours = np.array([integral.weight(DISC, g) @ integral.parts(g)[0] for g in shears])
    theirs = np.array([_evidence(lattice, sigma, g) for g in shears])
    # at the rim the grid's own error is 1e-3
    np.testing.assert_allclose(ours / ours[0], theirs / theirs[0], rtol=3e-3)


@pytest.mark.parametrize("e", [0.001 + 0.002j, 0.01 + 0.004j, 0.03j])
def test_the_second_derivative_of_a_narrow_likelihood_is_that_of_the_population(e):
    """An error of 1e-4 of the sum that does not move with g would be 100.

    The Laplacian of ln p is about -2/e0^2 - 1/|e|, averaged over the likelihood.
    """
    sigma, step = 0.001, 0.0002
    lattice = _lattice(e, sigma)
    integral = PolarIntegral(lattice, DISC.maximum)

    def second(evidence):
        sums = [evidence(step * each) for each in (0, 1, -1, 1j, -1j)]
        return (sum(sums[1:]) - 4 * sums[0]) / step**2 / sums[0]

    ours = second(lambda g: integral.weight(DISC, g) @ integral.parts(g)[0])
    theirs = second(lambda g: _evidence(lattice, sigma, g))
    assert ours == pytest.approx(theirs, abs=60)
    assert theirs < -200
