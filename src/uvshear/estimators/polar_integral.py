"""The integral over ellipticities on polar nodes of the unlensed ellipticity, over which g moves the likelihood.

The nodes hold the core of p, its kink at zero and its maximum. The likelihood, which is smooth, is interpolated between
the nodes of its lattice by a quintic spline.

Each derivative by g divides an error of the sum by the width sigma of the likelihood, except for errors of f that move
with it. Therefore f has vanished where the nodes end, and the nodes resolve f.
"""

import math
from functools import lru_cache

import numpy as np
from scipy.ndimage import distance_transform_edt, map_coordinates, spline_filter

from uvshear.estimators.shape_integral import ShapeIntegral, WeightedLattice
from uvshear.galaxy import EllipticityPrior
from uvshear.typing import Array, Complex, Float

_REACH, _EDGE = 6.5, 5.0
"""Standard deviations x of e over which the integral is taken, and those at which a window exp(-(x/5)^12) lets the
likelihood vanish, which is known out to four. Without the window a likelihood that ends at 5 sigma, at 4e-6 of its
maximum, adds 5e-5/sigma^2 to the curvature, whose mean is 20."""

_RADII, _ANGLES = 24, 64
"""Fewest nodes along the radius and along the angle, which resolve the population and the ridges of faint likelihoods.

With 20 and 32 one curvature of 220 at 10 to 20 uJy was wrong by 6 (and their mean, 5, by 1 per cent)."""

_SPACING, _FINE, _NARROW = 0.8, 0.3, 0.03
"""Largest distance between nodes in standard deviations of e, and the distance for standard deviations below the last
number. The first resolves a Gaussian to 1e-13, but the spline rings at the border of the lattice: at 0.8 the curvature
is uncertain by 4e-4/sigma^2, at 0.3 by less than 1e-4/sigma^2."""

_MOST = 150
"""Largest number of nodes along the radius and along the angle."""

_ORDER = 5
"""Order of the spline."""

_MARGIN = 4
"""Nodes that are added around the lattice for the spline."""


class PolarIntegral(ShapeIntegral):
    """Sum over polar nodes where the disc of unlensed ellipticities and the likelihood overlap.

    Parameters
    ----------
    maximum
        Largest modulus of the unlensed ellipticity.
    """

    def __init__(self, lattice: WeightedLattice, maximum: float) -> None:
        self.about = lattice.about
        self._find_nodes(lattice, maximum)
        likelihood = lattice.likelihood
        self._mean = np.array([[lattice.mean.real], [lattice.mean.imag]])
        self._precision = np.linalg.inv(lattice.covariance)
        # The last axis of the lattice is along ln alpha alone.
        axes = likelihood.axes[:2, :2]
        columns = likelihood.point[:, :2]
        low = columns.min(axis=0) - _MARGIN
        shape = tuple(np.ptp(columns, axis=0) + 2 * _MARGIN + 1)
        self._to_column, self._first = np.linalg.inv(axes), likelihood.origin[:2] + axes @ low
        flat = np.ravel_multi_index(tuple((columns - low).T), shape)
        count = int(np.prod(shape))
        seen = np.bincount(flat, minlength=count).reshape(shape) > 0
        _, nearest = distance_transform_edt(~seen, return_indices=True)
        place = axes @ np.indices(shape).reshape(2, -1) + self._first[:, None]
        depth = self._depth(place).reshape(shape)
        # Beyond its lattice the likelihood falls on as a Gaussian does.
        fall = np.exp(-np.maximum(depth - depth[tuple(nearest)], 0.0))
        self._splines = [
            spline_filter(
                fall * np.bincount(flat, part, minlength=count).reshape(shape)[tuple(nearest)],
                _ORDER,
            )
            for part in lattice.parts
        ]

    def _find_nodes(self, lattice: WeightedLattice, maximum: float) -> None:
        centre, (narrowest, widest) = lattice.unlensed_mean, lattice.extremes
        middle = abs(centre)
        spacing = narrowest * (_FINE if widest < _NARROW else _SPACING)
        if middle <= _REACH * widest:
            along, half = _REACH * widest, math.pi
            unit, share = _circle(_enough(2 * math.pi * (middle + widest) / spacing, _ANGLES))
        else:
            along, across = (_REACH * each for each in lattice.deviations())
            half = math.asin(min(across / middle, 1.0))
            unit, share = _legendre(_enough(2 * half * middle / spacing, _ANGLES))
        angle = np.angle(centre) + half * unit
        angular = half * share / (2 * np.pi)
        low, high = max(middle - along, 0.0), min(middle + along, maximum)
        unit, share = _legendre(_enough((high - low) / spacing, _RADII))
        radius = low + (high - low) * (unit + 1) / 2
        self._unlensed = (radius[:, None] * np.exp(1j * angle)).ravel()
        self._area = np.outer((high - low) / 2 * share, angular).ravel()

    def lensed(self, g: complex) -> Complex[Array, " node"]:
        """Return the ellipticities that a shear gives galaxies with the unlensed ellipticities."""
        return (self._unlensed + g) / (1 + np.conj(g) * self._unlensed)

    def parts(
        self, g: complex
    ) -> tuple[Float[Array, " node"], Float[Array, " node"], Float[Array, " node"]]:
        """Return f and its derivatives at the lensed ellipticities."""
        e = self.lensed(g)
        place = np.stack([e.real, e.imag])
        column = self._to_column @ (place - self._first[:, None])
        # The window moves with the likelihood, as an error of the spline does.
        window = np.exp(-((2 * self._depth(place) / _EDGE**2) ** 6))
        value, slope, bend = (
            window * map_coordinates(spline, column, order=_ORDER, prefilter=False, mode="nearest")
            for spline in self._splines
        )
        return value, slope, bend

    def weight(self, prior: EllipticityPrior, g: complex) -> Float[Array, " node"]:
        """Return the density of the modulus times the area of a node; it does not depend on the shear."""
        del g
        return self._area * prior.modulus_density(np.abs(self._unlensed))

    def _depth(self, place: Float[Array, "2 place"]) -> Float[Array, " place"]:
        """Return how far the Gaussian with the same moments has fallen from its maximum, in its logarithm."""
        away = place - self._mean
        depth: Float[Array, " place"] = 0.5 * np.sum(away * (self._precision @ away), axis=0)
        return depth


def _enough(steps: float, fewest: int) -> int:
    """Return the number of nodes for a number of steps; those of Gauss are furthest apart in the middle."""
    wanted = math.ceil(math.pi / 2 * max(steps, 0.0))
    return min(max(wanted, fewest), _MOST)


@lru_cache(maxsize=256)
def _legendre(count: int) -> tuple[Float[Array, " node"], Float[Array, " node"]]:
    """Return the nodes from -1 to 1 and the weights of Gauss and Legendre."""
    return np.polynomial.legendre.leggauss(count)


@lru_cache(maxsize=256)
def _circle(count: int) -> tuple[Float[Array, " node"], Float[Array, " node"]]:
    """Return equidistant nodes from -1 to 1, and their weights, for a function with the period of that interval."""
    return 2 * (np.arange(count) + 0.5) / count - 1, np.full(count, 2 / count)
