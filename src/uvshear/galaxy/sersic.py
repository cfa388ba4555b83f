"""Profiles other than the exponential disc: Sersic profiles, and a disc with a bulge."""

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.special import gammaincinv, j0

from uvshear.galaxy.exponential import Exponential
from uvshear.galaxy.profile import Profile
from uvshear.typing import Array, Float

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

HALF_LIGHT = 1.6783469900166605
"""Half-light radius of an exponential disc over its scale length."""

_SMALLEST, _LARGEST = 1e-6, 1e5
"""Limits of q between which the transform is tabulated on a logarithmic scale."""

_KNOTS, _NODES = 500, 10_000
"""Number of knots of the table, and of nodes of the Hankel transform at each knot."""


@dataclass(frozen=True)
class Sersic(Profile):
    r"""Profile with brightness proportional to exp(-b (r/r_h)^(1/n)).

    The half-light radius r_h is that of an exponential disc of scale length alpha.

    Parameters
    ----------
    index
        Sersic index n, from 0.5 (a Gaussian) to 4; n = 1 is :class:`Exponential`.

    Notes
    -----
    The Fourier transform has no closed form. It is tabulated once, with an error of 1e-6 for q up to 1e5.
    """

    index: float = 2.0

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Fourier transform at ``q`` >= 0, interpolated from the table."""
        values = _table(self.index)(np.log1p(np.minimum(q, _LARGEST) / _SMALLEST))
        return values.astype(np.asarray(q).dtype, copy=False)


@dataclass(frozen=True)
class DiscBulge(Profile):
    """Exponential disc with a de Vaucouleurs bulge at its centre, both of the same ellipticity.

    Parameters
    ----------
    fraction
        Fraction of the flux that is in the bulge.
    ratio
        Half-light radius of the bulge over that of the disc.
    """

    fraction: float = 0.2
    ratio: float = 0.5
    _disc: Profile = field(default_factory=Exponential)
    _bulge: Profile = field(default_factory=lambda: Sersic(4.0))

    def envelope(self, q: Float[Array, "..."]) -> Float[Array, "..."]:
        """Fourier transform at ``q`` >= 0, the sum of those of disc and bulge."""
        bulge = self._bulge.envelope(np.asarray(q) * np.asarray(q).dtype.type(self.ratio**2))
        return (1 - self.fraction) * self._disc.envelope(q) + self.fraction * bulge


@lru_cache(maxsize=16)
def _table(index: float) -> "CubicSpline":
    """Spline of the transform over ln(1 + 1e6 q), with q = (2 pi alpha k)^2 for a round galaxy."""
    from scipy.interpolate import CubicSpline  # noqa: PLC0415 - takes a tenth of a second

    b = float(gammaincinv(2 * index, 0.5))
    # With r/r_h = t^n the brightness is exp(-b t), and the integrand is smooth in sqrt(t) at the cusp.
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
    values = np.array([mass @ j0(wavenumber * radius) for wavenumber in k])
    return CubicSpline(x, values)
