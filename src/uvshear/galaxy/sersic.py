"""Galaxies that are not exponential discs: Sersic profiles, and a disc with a bulge."""

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import gammaincinv, j0

from uvshear.galaxy.exponential import Exponential
from uvshear.galaxy.profile import Profile
from uvshear.typing import Array, Float

HALF_LIGHT = 1.6783469900166605
"""Half-light radius of an exponential disc over its scale length."""

_LARGEST = 1e5
_SMALLEST = 1e-6
_KNOTS = 500
_NODES = 10_000


@dataclass(frozen=True)
class Sersic(Profile):
    r"""Surface brightness exp(-b (r/r_h)^(1/n)), with the half-light radius of the disc of scale length alpha.

    Parameters
    ----------
    index
        n: 1 is :class:`Exponential`, 0.5 a Gaussian; 0.5 to 4.

    Notes
    -----
    Its Fourier transform has no closed form: it is tabulated once, to 1e-6 for q up to 1e5.
    """

    index: float = 2.0

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Interpolated Hankel transform."""
        values = _table(self.index)(np.log1p(np.minimum(q, _LARGEST) / _SMALLEST))
        return values.astype(np.asarray(q).dtype, copy=False)


@dataclass(frozen=True)
class DiscBulge(Profile):
    """Exponential disc with a de Vaucouleurs bulge in its middle, of the same ellipticity.

    Parameters
    ----------
    fraction
        Of the flux in the bulge.
    ratio
        Half-light radius of the bulge over the disc's.
    """

    fraction: float = 0.2
    ratio: float = 0.5
    _disc: Profile = field(default_factory=Exponential)
    _bulge: Profile = field(default_factory=lambda: Sersic(4.0))

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Sum of the two."""
        bulge = self._bulge.envelope(np.asarray(q) * np.asarray(q).dtype.type(self.ratio**2))
        return (1 - self.fraction) * self._disc.envelope(q) + self.fraction * bulge


@lru_cache(maxsize=16)
def _table(index: float) -> CubicSpline:
    """Spline of the transform over ln(1 + 1e6 q), q = (2 pi alpha k)^2 of a round galaxy."""
    b = float(gammaincinv(2 * index, 0.5))
    # r/r_h = t^n makes the brightness exp(-b t); the integrand is smooth in sqrt(t) at the cusp.
    nodes, weights = np.polynomial.legendre.leggauss(200)
    panels = _NODES // 200
    edges = np.linspace(0, 1, panels + 1)
    s = (edges[:-1, None] + (nodes + 1) / 2 / panels).ravel()
    weight = np.tile(weights / 2 / panels, panels)
    t_max = 45 / b
    t, dt = t_max * s**2, 2 * t_max * s
    radius = HALF_LIGHT * t**index
    mass = weight * np.exp(-b * t) * t ** (2 * index - 1) * dt
    mass /= mass.sum()
    x = np.linspace(0, math.log1p(_LARGEST / _SMALLEST), _KNOTS)
    k = np.sqrt(_SMALLEST * np.expm1(x))
    values = np.array([mass @ j0(one * radius) for one in k])
    return CubicSpline(x, values)
