"""Gradient and curvature of ln P(D|g) against sums over every parameter."""

import numpy as np
import pytest

from uvshear.constants import MICROJANSKY
from uvshear.estimators.evidence import evidence_and_gradient, gradient_and_curvature
from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.population_fit import moved
from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.geometry.ellipticity import add_shear

POPULATION = UnlensedPopulation()
FLUX, FLUX_SIGMA = 20 * MICROJANSKY, 1.5 * MICROJANSKY


class Toy:
    """A Gaussian likelihood of e, ln alpha and S, with a correlation of the first two."""

    def __init__(self, e, sigma, size=0.3, size_sigma=0.25, slope=0.6):
        self.e, self.sigma = e, sigma
        self.size = float(POPULATION.size.log_median(np.array([FLUX]))[0]) + size
        self.size_sigma, self.slope = size_sigma, slope

    def log(self, e, size):
        expected = self.size + self.slope * (e - self.e).real
        return (
            -0.5 * np.abs((e - self.e) / self.sigma) ** 2
            - 0.5 * ((size - expected) / self.size_sigma) ** 2
        )

    def on_lattice(self):
        """As the fit gives it: steps of 0.9 sigma, no wider than 0.08 in e, down by exp(-8), within the disc."""
        step = min(0.9 * self.sigma, 0.08)
        n, k = int(5 * self.sigma / step) + 1, 6
        point = np.stack(np.meshgrid(*[np.arange(-n, n + 1)] * 2, np.arange(-k, k + 1)), -1)
        point = point.reshape(-1, 3)
        axes = np.diag([step, step, 0.9 * self.size_sigma])
        axes[2, 0] = self.slope * step
        origin = np.array([self.e.real, self.e.imag, self.size])
        nodes = origin + point @ axes.T
        log = self.log(nodes[:, 0] + 1j * nodes[:, 1], nodes[:, 2])
        kept = (log > log.max() - 10) & (np.hypot(nodes[:, 0], nodes[:, 1]) < 0.95)
        count = int(kept.sum())
        flux, variance = np.full(count, FLUX), np.full(count, FLUX_SIGMA**2)
        return ShapeLikelihood(point[kept], origin, axes, log[kept], flux, variance)


def _evidence(toy, g, population=POPULATION):
    """Sum over a grid of the observed e, ln alpha and S."""
    x = np.arange(-0.96, 0.96, 0.012) + 0.0013
    e = (x[:, None] + 1j * x[None, :]).ravel()
    e = e[(np.abs(e) < 0.95) & (np.abs(e - toy.e) < 6 * toy.sigma)]
    size = toy.size + np.linspace(-1.5, 1.5, 15)
    s = FLUX + FLUX_SIGMA * np.linspace(-5, 5, 11)
    unlensed = add_shear(e, -g)
    r = (1 - abs(g) ** 2) / np.abs(1 - np.conj(g) * e) ** 2
    of_size = size[None, :, None] + 0.5 * np.log(r)[:, None, None]
    t = (of_size - population.size.log_median(s)) / population.size.sigma
    of_flux = population.flux.density(s) * np.exp(-0.5 * ((s - FLUX) / FLUX_SIGMA) ** 2)
    prior = np.sum(np.exp(-0.5 * t**2) * of_flux, axis=-1) / population.size.sigma
    density = np.exp(population.ellipticity.log_density(unlensed)) * r**2
    return np.sum(density[:, None] * prior * np.exp(toy.log(e[:, None], size)))


def _brute_force(toy, about, step=0.02):
    """q and h by differences, of the fourth order in ``step``: the grid meets kinks of the prior."""
    log = {
        (i, j): np.log(_evidence(toy, about + step * (i + 1j * j)))
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
    }
    q = np.array([log[1, 0] - log[-1, 0], log[0, 1] - log[0, -1]]) / (2 * step)
    xx = (log[1, 0] + log[-1, 0] - 2 * log[0, 0]) / step**2
    yy = (log[0, 1] + log[0, -1] - 2 * log[0, 0]) / step**2
    xy = (log[1, 1] + log[-1, -1] - log[1, -1] - log[-1, 1]) / (4 * step**2)
    return q, -np.array([[xx, xy], [xy, yy]])


@pytest.mark.parametrize("about", [0j, 0.05 - 0.02j])
@pytest.mark.parametrize(
    ("e", "sigma"), [(0.25 + 0.1j, 0.2), (0.05j, 0.15), (-0.5 + 0.3j, 0.1), (0.3 - 0.3j, 0.05)]
)
def test_gradient_and_curvature_are_those_of_brute_force(e, sigma, about):
    toy = Toy(e, sigma)
    q, h = gradient_and_curvature(toy.on_lattice(), POPULATION, about)
    exact_q, exact_h = _brute_force(toy, about)
    # the grid's own errors are the larger part
    np.testing.assert_allclose(q, exact_q, atol=0.02 * np.hypot(*exact_q) + 0.02)
    np.testing.assert_allclose(h, exact_h, atol=0.04 * np.abs(exact_h).max() + 0.1)


@pytest.mark.parametrize(
    ("e", "sigma"), [(0.25 + 0.1j, 0.2), (0.05j, 0.15), (-0.5 + 0.3j, 0.1), (0.3 - 0.3j, 0.05)]
)
def test_the_gradient_by_the_population_is_that_of_brute_force(e, sigma):
    """By mu, ln sigma and the logarithms of both scales of the ellipticities."""
    toy, about, step = Toy(e, sigma), 0.05 - 0.02j, 0.03
    steps = step * np.eye(4)
    expected = [
        (
            np.log(_evidence(toy, about, moved(POPULATION, change)))
            - np.log(_evidence(toy, about, moved(POPULATION, -change)))
        )
        / (2 * step)
        for change in steps
    ]
    sides = [
        (moved(POPULATION, change).ellipticity, moved(POPULATION, -change).ellipticity)
        for change in steps[2:]
    ]
    _, gradient = evidence_and_gradient(toy.on_lattice(), POPULATION, about, sides, 2 * step)
    np.testing.assert_allclose(gradient, expected, atol=0.004)


def test_log_evidences_of_two_populations_differ_as_brute_force_has_it():
    toy = Toy(0.25 + 0.1j, 0.2)
    other = moved(POPULATION, np.array([0.1, 0.2, 0.3, -0.4]))
    lattice = toy.on_lattice()
    both = (POPULATION, other)
    found = [evidence_and_gradient(lattice, population, 0.02j)[0] for population in both]
    expected = [np.log(_evidence(toy, 0.02j, population)) for population in both]
    assert abs(np.diff(expected)[0]) > 0.05
    assert np.diff(found)[0] == pytest.approx(np.diff(expected)[0], abs=0.004)


def test_the_population_behind_a_shear_is_seen_where_it_is():
    """With perfect shapes the estimate is the shear: q pulls towards it from either side."""
    rng = np.random.default_rng(8)
    g = 0.04 + 0.03j
    modulus = POPULATION.ellipticity.draw_modulus(300, rng)
    intrinsic = modulus * np.exp(2j * np.pi * rng.uniform(size=300))
    total, curvature = np.zeros(2), np.zeros((2, 2))
    # rings: e and -e
    for e in add_shear(np.concatenate([intrinsic, -intrinsic]), g):
        q, h = gradient_and_curvature(Toy(complex(e), 0.02, size=0).on_lattice(), POPULATION, g)
        total, curvature = total + q, curvature + h
    estimate = np.linalg.solve(curvature, total)
    error = np.sqrt(np.diag(np.linalg.inv(curvature)))
    assert np.all(error < 0.015)
    assert np.all(np.abs(estimate) < 2 * error)


def _narrow(e, sigma, size=0.0):
    return Toy(complex(e), sigma, size=size, size_sigma=2 * sigma, slope=0.0).on_lattice()


@pytest.mark.parametrize("sigma", [0.01, 0.003, 0.0003])
def test_the_curvature_of_a_precise_shape_is_that_of_the_population(sigma):
    r"""For |e| = m and a median size, with p = exp f, the trace of h is

    .. math:: -(f'' + f'/m) (1 - m^2)^2 + 8 + m^2/\sigma_\alpha^2

    up to 0.08 by the width of the flux. An error of 1e-4 of the evidence that does not move with g would be 1100 at
    sigma = 0.0003.
    """
    m, step = 0.45, 1e-3
    f = POPULATION.ellipticity.log_density(m + step * np.arange(-1, 2) + 0j)
    laplacian = (f[0] + f[2] - 2 * f[1]) / step**2 + (f[2] - f[0]) / (2 * step * m)
    expected = -laplacian * (1 - m**2) ** 2 + 8 + m**2 / POPULATION.size.sigma**2
    for turn in np.exp(1j * np.array([0.1, 0.8, 3.0])):
        _, h = gradient_and_curvature(_narrow(m * turn, sigma), POPULATION, 0j)
        assert np.trace(h) == pytest.approx(expected, abs=0.12 + 30 * sigma)
    assert expected == pytest.approx(16.7, abs=0.1)


def test_the_mean_curvature_is_the_mean_square_of_the_gradient():
    """The information equality, for precise shapes anywhere in the disc: its centre and its rim take their part.

    With an integral that ended at 5 sigma the curvature was 2.4 times as large.
    """
    rng = np.random.default_rng(3)
    number, sigma, g = 400, 0.003, 0.03 + 0j
    modulus = POPULATION.ellipticity.draw_modulus(number, rng)
    e = add_shear(modulus * np.exp(2j * np.pi * rng.uniform(size=number)), g)
    e = e + sigma * (rng.normal(size=number) + 1j * rng.normal(size=number))
    size = POPULATION.size.sigma * rng.normal(size=number)
    found = [
        gradient_and_curvature(_narrow(a, sigma, b), POPULATION, g)
        for a, b in zip(e, size, strict=True)
    ]
    excess = np.array([np.trace(np.outer(q, q) - h) for q, h in found])
    error = excess.std() / number**0.5
    assert abs(excess.mean()) < 3 * error
    assert error < 0.15 * np.mean([np.trace(h) for _, h in found])


def test_a_galaxy_far_beyond_the_rim_does_not_occur():
    """It would have a curvature of 1/sigma^2, and outweigh all others."""
    maximum, sigma = POPULATION.ellipticity.maximum, 0.003
    inside, outside = (
        gradient_and_curvature(_narrow(maximum + x * sigma, sigma), POPULATION, 0j)
        for x in (3.0, 4.5)
    )
    assert inside[1].any()
    assert not any(part.any() for part in outside)


def test_a_galaxy_that_the_population_does_not_have_says_nothing():
    toy = Toy(0.2 + 0j, 0.1)
    likelihood = toy.on_lattice()
    faint = ShapeLikelihood(
        likelihood.point,
        likelihood.origin,
        likelihood.axes,
        likelihood.log_likelihood,
        likelihood.flux / 10,
        likelihood.flux_variance / 100,
    )
    q, h = gradient_and_curvature(faint, POPULATION, 0j)
    assert not q.any()
    assert not h.any()


class Rim(Toy):
    """A likelihood that rises to the rim of the disc, tenfold a node of 0.08, on either side of it."""

    def log(self, e, size):
        along = np.abs((e * np.exp(-1j * np.pi / 4)).real)
        across = (e * np.exp(-1j * np.pi / 4)).imag
        log = 28 * along - 0.5 * (across / 0.25) ** 2 - 0.5 * ((size - self.size) / 0.25) ** 2
        return np.where(np.abs(e) < 0.955, log, -np.inf)


@pytest.mark.parametrize("about", [0j, 0.02 + 0.02j])
def test_what_the_spline_rings_with_is_no_curvature(about):
    """Inside the population's disc the likelihood is decades lower than at the rim: no more than a galaxy's own."""
    galaxy = Rim(0j, 0.4).on_lattice()
    q, h = gradient_and_curvature(galaxy, POPULATION, about)
    assert np.abs(q).max() < 30
    assert np.abs(h).max() < 300
