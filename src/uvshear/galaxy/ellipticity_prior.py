"""Distribution of ellipticities: a density over the plane of e, the same in all directions."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Complex, Float

_NODES = 20_001
"""Number of nodes of the integrals over the modulus. The error of the trapezoidal rule is below 1e-8 for both priors of
this file."""


class EllipticityPrior(ABC):
    r"""Isotropic prior on the complex ellipticity within the disc abs(e) < ``maximum``.

    A subclass defines ``maximum`` and :meth:`relative_density`. Its normalisation is found numerically, and the density
    per area of the plane of e is

    .. math:: p(e) = \frac{P(|e|)}{2\pi |e|},\quad \int_0^{e_\mathrm{max}} P(r)\,dr = 1
    """

    maximum: float

    @abstractmethod
    def relative_density(self, modulus: Float[Array, "..."]) -> Float[Array, "..."]:
        """Density per area at a modulus in [0, ``maximum``), up to a constant factor."""

    def log_density(self, e: Complex[Array, "..."]) -> Float[Array, "..."]:
        """Logarithm of the density per area of the plane of e, -inf outside the disc."""
        modulus = np.abs(e)
        inside = modulus < self.maximum
        relative = self.relative_density(np.where(inside, modulus, 0.0))
        log = np.log(relative) - math.log(self._integral)
        return np.where(inside, log, -np.inf)

    def modulus_density(self, modulus: Float[Array, "..."]) -> Float[Array, "..."]:
        """Density P of the modulus, 0 outside [0, ``maximum``)."""
        inside = (modulus >= 0) & (modulus < self.maximum)
        r = np.where(inside, modulus, 0.0)
        return 2 * np.pi * r * self.relative_density(r) / self._integral

    def draw_modulus(self, number: int, rng: np.random.Generator) -> Float[Array, " source"]:
        """Draw moduli, using the inverse of their cumulative distribution."""
        r, mass = self._modulus_mass
        cumulative = _integrals(mass, r) / self._integral
        return np.interp(rng.uniform(size=number), cumulative, r)

    @cached_property
    def population_variance(self) -> float:
        """Variance of each component of e, which is half the mean of its squared modulus."""
        r, mass = self._modulus_mass
        return float(_integrals(r**2 * mass, r)[-1] / self._integral / 2)

    @cached_property
    def _modulus_mass(self) -> tuple[Float[Array, " sample"], Float[Array, " sample"]]:
        r = np.linspace(0, self.maximum, _NODES)
        inside = np.minimum(r, np.nextafter(self.maximum, 0))
        return r, 2 * np.pi * r * self.relative_density(inside)

    @cached_property
    def _integral(self) -> float:
        r, mass = self._modulus_mass
        return float(_integrals(mass, r)[-1])


def _integrals(values: Float[Array, " node"], r: Float[Array, " node"]) -> Float[Array, " node"]:
    """Integrals from the first node to each of them, by the trapezoidal rule."""
    parts = np.diff(r) * (values[1:] + values[:-1]) / 2
    return np.concatenate([[0.0], np.cumsum(parts)])


@dataclass(frozen=True)
class FlatEllipticityPrior(EllipticityPrior):
    r"""Uniform density over the disc, the default of the measurement.

    .. math:: p(e) = \frac{1}{\pi e_\mathrm{max}^2}

    Parameters
    ----------
    maximum
        Upper bound of abs(e), below 1.
    """

    maximum: float = 0.95

    def __post_init__(self) -> None:
        _check_maximum(self.maximum)

    def relative_density(self, modulus: Float[Array, "..."]) -> Float[Array, "..."]:
        """Return 1 everywhere."""
        return np.ones_like(modulus)


@dataclass(frozen=True)
class DiscEllipticityPrior(EllipticityPrior):
    r"""Density of inclined discs of finite thickness, fitted to galaxies of VLA-COSMOS.

    .. math::
        P(|e|) = \frac{N |e| \left(1 - \exp\left[(|e| - e_\mathrm{max})/c\right]\right)}
        {(1 + |e|) (|e|^2 + e_0^2)^{1/2}}

    Parameters
    ----------
    c
        Width of the cut-off at the maximum.
    e0
        Modulus below which the density flattens towards round discs.
    maximum
        Upper bound of abs(e), where the density vanishes.

    References
    ----------
    Rivi & Miller 2018, section 3 (unnumbered), after Miller et al. 2013.

    Notes
    -----
    The paper gives N = 2.595 and no maximum. Its c and e0 give N = 2.5784 with Miller's maximum of 0.804 and 2.5944
    with 0.8: the paper's normalisation belongs to a maximum of 0.8, or is 0.6 per cent off.
    """

    c: float = 0.2298
    e0: float = 0.0732
    maximum: float = 0.804

    def __post_init__(self) -> None:
        _check_maximum(self.maximum)
        if not (self.c > 0 and self.e0 > 0):
            raise InputError(
                f"ellipticity prior: c is {self.c} and e0 is {self.e0}; both must be positive"
            )

    def relative_density(self, modulus: Float[Array, "..."]) -> Float[Array, "..."]:
        """P(|e|) / |e| without its constant factors."""
        cut = -np.expm1((modulus - self.maximum) / self.c)
        return cut / ((1 + modulus) * np.sqrt(modulus**2 + self.e0**2))


def _check_maximum(maximum: float) -> None:
    if not 0 < maximum < 1:
        raise InputError(f"ellipticity prior: maximum is {maximum}; it must lie between 0 and 1")
