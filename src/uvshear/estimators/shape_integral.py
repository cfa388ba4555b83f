r"""The integral of a galaxy's likelihood over unlensed ellipticities.

With f(e) the likelihood times the prior of size and flux, integrated over both, and p the density of unlensed
ellipticities e_s per unit area,

.. math:: P(D|g) = \int f(e)\, p(e_s)\, d^2 e_s = \int f(e)\, p(e_s)\, r^2\, d^2 e
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.galaxy import EllipticityPrior
from uvshear.typing import Array, Complex, Float

SHARPEST = 1e-6
"""Smallest standard deviation of e."""

_FLUX_REACH = 5.0
"""Standard deviations of the flux to either side over which the integral is taken."""

_FLUXES, _WEIGHTS = np.polynomial.legendre.leggauss(24)


class ShapeIntegral(ABC):
    """Nodes and weights of the integral for one galaxy, for every shear near that of an expansion.

    Attributes
    ----------
    about
        Shear of the expansion.
    """

    about: complex

    @abstractmethod
    def lensed(self, g: complex) -> Complex[Array, " node"]:
        """Return the lensed ellipticity e of every node."""

    @abstractmethod
    def parts(
        self, g: complex
    ) -> tuple[Float[Array, " node"], Float[Array, " node"], Float[Array, " node"]]:
        """Return f with the unlensed sizes at the shear of the expansion, and its first two derivatives by ln alpha."""

    @abstractmethod
    def weight(self, prior: EllipticityPrior, g: complex) -> Float[Array, " node"]:
        """Return the weight of every node, which holds the density of unlensed ellipticities."""

    def terms(self, prior: EllipticityPrior, g: complex) -> Float[Array, " node"]:
        """Return the terms of the sum for P(D|g)."""
        value, slope, bend = self.parts(g)
        e = self.lensed(g)
        further = log_stretch(e, g) - log_stretch(e, self.about)
        return self.weight(prior, g) * (value + further * slope + 0.5 * further**2 * bend)


@dataclass(frozen=True)
class WeightedLattice:
    """The likelihood at the nodes of its lattice, times the prior of size and flux.

    Parameters
    ----------
    likelihood
        The likelihood.
    about
        Shear that gives the unlensed sizes.
    parts
        The product, integrated over flux, and its first two derivatives by ln alpha.
    mean
        Mean of e.
    covariance
        Covariance of the components of e.
    """

    likelihood: ShapeLikelihood
    about: complex
    parts: tuple[Float[Array, " node"], ...]
    mean: complex
    covariance: Float[Array, "2 2"]

    @classmethod
    def weighted(
        cls, likelihood: ShapeLikelihood, population: UnlensedPopulation, about: complex
    ) -> Self | None:
        """Return the product for a population; None where it has no galaxies of such sizes and fluxes."""
        e = likelihood.ellipticity
        weight = np.exp(likelihood.log_likelihood - likelihood.log_likelihood.max())
        sizes = _size_and_flux(likelihood, population, log_stretch(e, about))
        parts = tuple(weight * part for part in sizes)
        mass = parts[0].sum()
        if not mass > 0:
            return None
        share = parts[0] / mass
        mean = complex(share @ e)
        away = np.stack([(e - mean).real, (e - mean).imag])
        covariance = (share * away) @ away.T + SHARPEST**2 * np.eye(2)
        return cls(likelihood, about, parts, mean, covariance)

    @property
    def sigma(self) -> float:
        """Standard deviation of a component of e."""
        return math.sqrt(np.trace(self.covariance) / 2)

    @property
    def unlensed_mean(self) -> complex:
        """Ellipticity that the lens maps to the mean."""
        return (self.mean - self.about) / (1 - self.about.conjugate() * self.mean)

    @property
    def lens(self) -> complex:
        """Derivative of e by the unlensed ellipticity at the mean: the lens stretches and turns its surroundings."""
        of_mean = 1 + self.about.conjugate() * self.unlensed_mean
        return (1 - abs(self.about) ** 2) / of_mean**2

    @property
    def extremes(self) -> tuple[float, float]:
        """Smallest and largest standard deviations of the unlensed ellipticity over all directions."""
        low, high = np.sqrt(np.linalg.eigvalsh(self.covariance)) / abs(self.lens)
        return float(low), float(high)

    def deviations(self) -> tuple[float, float]:
        """Return the standard deviations of the unlensed ellipticity along its radius and across."""
        turned = self.unlensed_mean * self.lens
        along = np.array([turned.real, turned.imag]) / abs(turned)
        across = np.array([-along[1], along[0]])
        radial, tangential = (math.sqrt(each @ self.covariance @ each) for each in (along, across))
        return radial / abs(self.lens), tangential / abs(self.lens)


def log_stretch(e: Complex[Array, " node"], g: complex) -> Float[Array, " node"]:
    """Return (ln r)/2, which the inverse of the lens adds to ln alpha."""
    return 0.5 * (np.log1p(-(abs(g) ** 2)) - np.log(np.abs(1 - np.conj(g) * e) ** 2))


def _size_and_flux(
    likelihood: ShapeLikelihood, population: UnlensedPopulation, stretch: Float[Array, " node"]
) -> tuple[Float[Array, " node"], Float[Array, " node"], Float[Array, " node"]]:
    """Return the prior of size and flux at each node, integrated over flux, and its derivatives by ln alpha."""
    flux, sigma = likelihood.flux, np.sqrt(likelihood.flux_variance)
    law, relation = population.flux, population.size
    low = max(law.minimum, float(np.min(flux - _FLUX_REACH * sigma)))
    high = min(law.maximum, float(np.max(flux + _FLUX_REACH * sigma)))
    if not low < high:
        nothing = np.zeros_like(flux)
        return nothing, nothing, nothing
    s = low + (high - low) * (_FLUXES + 1) / 2
    prior = _WEIGHTS * law.density(s) * (high - low) / 2
    away = (s - flux[:, None]) / sigma[:, None]
    given = np.exp(-0.5 * away**2) / sigma[:, None] * prior
    size = likelihood.log_scale_length + stretch
    t = (size[:, None] - relation.log_median(s)) / relation.sigma
    density = given * np.exp(-0.5 * t**2) / relation.sigma
    by_first = -t / relation.sigma
    by_second = (t**2 - 1) / relation.sigma**2
    return (
        density.sum(axis=1),
        np.sum(density * by_first, axis=1),
        np.sum(density * by_second, axis=1),
    )
