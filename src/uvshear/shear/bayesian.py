r"""Shear from likelihoods: the population's prior behind a shear, to second order about an estimate of it.

Each galaxy has a likelihood over (e, ln alpha), position and flux taken care of. The galaxies behind a shear g are
those of the unlensed population, mapped: with

.. math::
    e_s = \frac{e - g}{1 - g^* e},\quad r = \frac{1 - |g|^2}{|1 - g^* e|^2},\quad
    \ln\alpha_s = \ln\alpha + \tfrac12 \ln r

the density of (e, ln alpha, S) is p(e_s) r^2 p(ln alpha_s | S) p(S), p(e) per area of the disc, and

.. math::
    P(D|g) = \int L\, p,\quad q = \nabla \ln P,\quad h = -\nabla\nabla \ln P,\quad
    \hat g = g_0 + \Big(\sum h\Big)^{-1} \sum q

with q and h taken at g_0, which is then put at g^ (Bernstein & Armstrong 2014, eq. 8 to 12, about g = 0; Sheldon 2014).
About zero the core of the ellipticities, 0.07 wide, makes the third order matter: m = 0.01 at \|g\| = 0.03.
"""

from dataclasses import dataclass, field

import numpy as np

from uvshear.galaxy import (
    DiscEllipticityPrior,
    EllipticityPrior,
    PowerLawFlux,
    SizeFluxRelation,
)
from uvshear.typing import Array, Complex, Float

STEP = 0.005
"""Of the differences in g."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_REACH = 5.0
"""Standard deviations of the flux on either side."""


@dataclass(frozen=True)
class UnlensedPopulation:
    """Distributions of what is lensed: flux, scale length at a flux, ellipticity."""

    flux: PowerLawFlux = field(default_factory=PowerLawFlux)
    size: SizeFluxRelation = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=DiscEllipticityPrior)


@dataclass(frozen=True)
class ShapeLikelihood:
    """Likelihood of one galaxy at nodes of a quadrature over (e, ln alpha) with equal weights.

    Parameters
    ----------
    ellipticity, log_scale_length
        The nodes; ln(scale length / rad).
    log_likelihood
        With the flux integrated over all values, and the position.
    flux, flux_variance
        Mean and variance of the flux at each node [Jy].
    """

    ellipticity: Complex[Array, " node"]
    log_scale_length: Float[Array, " node"]
    log_likelihood: Float[Array, " node"]
    flux: Float[Array, " node"]
    flux_variance: Float[Array, " node"]


def gradient_and_curvature(
    likelihood: ShapeLikelihood, population: UnlensedPopulation, about: complex
) -> tuple[Float[Array, " 2"], Float[Array, "2 2"]]:
    """Work out q and h of one galaxy at the shear ``about``; both zero where the population has no such galaxy."""
    offsets = STEP * np.array([0, 1, -1, 1j, -1j, 1 + 1j, -1 - 1j, 1 - 1j, -1 + 1j])
    e = likelihood.ellipticity
    centre = _log_stretch(e, about)
    weight = np.exp(likelihood.log_likelihood - likelihood.log_likelihood.max())
    sizes = _size_and_flux(likelihood, population, centre)
    evidence = np.empty(len(offsets))
    for k, offset in enumerate(offsets):
        g = about + offset
        further = _log_stretch(e, g) - centre
        unlensed = (e - g) / (1 - np.conj(g) * e)
        density = np.exp(population.ellipticity.log_density(unlensed) + 4 * (centre + further))
        by_size = sizes[0] + further * sizes[1] + 0.5 * further**2 * sizes[2]
        evidence[k] = np.sum(weight * density * by_size)
    p, right, left, up, down, ne, sw, se, nw = evidence.tolist()
    if not p > 0:
        return np.zeros(2), np.zeros((2, 2))
    q = np.array([right - left, up - down]) / (2 * STEP * p)
    mixed = (ne + sw - se - nw) / (4 * STEP**2 * p)
    second = np.array(
        [
            [(right + left - 2 * p) / (STEP**2 * p), mixed],
            [mixed, (up + down - 2 * p) / (STEP**2 * p)],
        ]
    )
    return q, np.outer(q, q) - second


def _log_stretch(e: Complex[Array, " node"], g: complex) -> Float[Array, " node"]:
    """(ln r)/2: what unlensing adds to ln alpha."""
    return 0.5 * (np.log1p(-(abs(g) ** 2)) - np.log(np.abs(1 - np.conj(g) * e) ** 2))


def _size_and_flux(
    likelihood: ShapeLikelihood, population: UnlensedPopulation, stretch: Float[Array, " node"]
) -> tuple[Float[Array, " node"], Float[Array, " node"], Float[Array, " node"]]:
    """Prior of size and flux at each node, the flux integrated, and its derivatives by ln alpha."""
    flux, sigma = likelihood.flux, np.sqrt(likelihood.flux_variance)
    law, relation = population.flux, population.size
    low = max(law.minimum, float(np.min(flux - _REACH * sigma)))
    high = min(law.maximum, float(np.max(flux + _REACH * sigma)))
    if not low < high:
        nothing = np.zeros_like(flux)
        return nothing, nothing, nothing
    s = low + (high - low) * (_NODES + 1) / 2
    prior = _WEIGHTS * law.density(s) * (high - low) / 2
    away = (s - flux[:, None]) / sigma[:, None]
    given = np.exp(-0.5 * away**2) / sigma[:, None] * prior
    size = likelihood.log_scale_length + stretch
    t = (size[:, None] - relation.log_median(s)) / relation.sigma
    density = given * np.exp(-0.5 * t**2)
    by_first = -t / relation.sigma
    by_second = (t**2 - 1) / relation.sigma**2
    return (
        density.sum(axis=1),
        np.sum(density * by_first, axis=1),
        np.sum(density * by_second, axis=1),
    )
