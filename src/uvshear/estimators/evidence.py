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

The integral is taken over the unlensed e_s, where the population is at rest: its core, its kink at zero and its end are
then met by nodes made for them, and it is the smooth likelihood that g moves. Between its own nodes, a lattice, the
likelihood is a quintic spline, of its integrals over ln alpha and S.
"""

import math
from collections.abc import Sequence

import numpy as np
from scipy.ndimage import distance_transform_edt, map_coordinates, spline_filter

from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.galaxy import EllipticityPrior
from uvshear.typing import Array, Complex, Float

STEP = 0.1
"""Of the differences in g, over the standard deviation of e; no more than ``WIDEST_STEP``."""

WIDEST_STEP = 0.01
RINGING = 0.05
"""Negative part of the evidence, over the evidence, from which it is the spline's own: of a galaxy whose likelihood is
all but outside the population's disc, decades lower inside, the ringing is left. One look of 63 000 had a curvature of
thousands; of 1214 others none was above 0.006."""

_REACH = 5.0
"""Standard deviations of e and of the flux that are integrated over."""

_RADII, _RADIAL = np.polynomial.legendre.leggauss(20)
_ANGLES, _ANGULAR = np.polynomial.legendre.leggauss(32)
_FLUXES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
_ORDER = 5
_MARGIN = 4
"""Nodes around the lattice's own, for the spline."""


def evidence_and_gradient(
    likelihood: ShapeLikelihood,
    population: UnlensedPopulation,
    about: complex,
    sides: Sequence[tuple[EllipticityPrior, EllipticityPrior]] = (),
    difference: float = 1.0,
) -> tuple[float, Float[Array, " parameter"]]:
    r"""Ln P(D|g) of one galaxy at the shear ``about``, up to a constant that no population changes; and its gradient.

    Of the lognormal sizes t = (ln alpha_s - mu)/sigma, so that the derivatives by mu and ln sigma are the averages of
    t/sigma and t^2 - 1 over the galaxy's posterior: those by ln alpha, which a shear needs, give both.

    Parameters
    ----------
    sides
        Ellipticity priors on either side of the population's, up to the same maximum: one pair a parameter of theirs.
    difference
        Between the parameters of a pair.

    Returns
    -------
    log_evidence
        -inf where the population has no such galaxy.
    gradient
        By the ln of the median size, the ln of its scatter, and the parameters of ``sides``; zeros where there is none.
    """
    surface = _Surface(likelihood, population, about)
    unlensed, weight = _nodes(population.ellipticity, surface, about)
    value, slope, bend = surface.parts(unlensed, about)
    evidence = float(weight @ value)
    if _rings(weight * value) or not evidence > 0:
        return -math.inf, np.zeros(2 + len(sides))
    gradient = [-weight @ slope, population.size.sigma**2 * (weight @ bend)]
    for up, down in sides:
        change = _nodes(up, surface, about)[1] - _nodes(down, surface, about)[1]
        gradient.append(change @ value / difference)
    return math.log(evidence), np.array(gradient) / evidence


def gradient_and_curvature(
    likelihood: ShapeLikelihood, population: UnlensedPopulation, about: complex
) -> tuple[Float[Array, " 2"], Float[Array, "2 2"]]:
    """Work out q and h of one galaxy at the shear ``about``; both zero where the population has no such galaxy."""
    surface = _Surface(likelihood, population, about)
    unlensed, weight = _nodes(population.ellipticity, surface, about)
    if _rings(weight * surface.at(unlensed, about)):
        return np.zeros(2), np.zeros((2, 2))
    step = min(STEP * surface.sigma, WIDEST_STEP)
    offsets = step * np.array([0, 1, -1, 1j, -1j, 1 + 1j, -1 - 1j, 1 - 1j, -1 + 1j])
    evidence = [float(weight @ surface.at(unlensed, about + offset)) for offset in offsets]
    p, right, left, up, down, ne, sw, se, nw = evidence
    if not p > 0:
        return np.zeros(2), np.zeros((2, 2))
    q = np.array([right - left, up - down]) / (2 * step * p)
    mixed = (ne + sw - se - nw) / (4 * step**2 * p)
    second = np.array(
        [
            [(right + left - 2 * p) / (step**2 * p), mixed],
            [mixed, (up + down - 2 * p) / (step**2 * p)],
        ]
    )
    return q, np.outer(q, q) - second


def _rings(parts: Float[Array, " node"]) -> bool:
    """Whether so much of the evidence is negative that it is the spline's own."""
    return bool(-parts[parts < 0].sum() > RINGING * parts.sum())


class _Surface:
    """Likelihood times the prior of the size, both integrated over size and flux, as a function of e and g."""

    def __init__(
        self, likelihood: ShapeLikelihood, population: UnlensedPopulation, about: complex
    ) -> None:
        e, weight = (
            likelihood.ellipticity,
            np.exp(likelihood.log_likelihood - likelihood.log_likelihood.max()),
        )
        self._about = about
        sizes = _size_and_flux(likelihood, population, _log_stretch(e, about))
        columns = likelihood.point[:, :2]
        low = columns.min(axis=0) - _MARGIN
        shape = tuple(np.ptp(columns, axis=0) + 2 * _MARGIN + 1)
        flat = np.ravel_multi_index(tuple((columns - low).T), shape)
        count = int(np.prod(shape))
        seen = np.bincount(flat, minlength=count).reshape(shape) > 0
        _, nearest = distance_transform_edt(~seen, return_indices=True)
        self._splines = [
            spline_filter(
                np.bincount(flat, weight * one, minlength=count).reshape(shape)[tuple(nearest)],
                _ORDER,
            )
            for one in sizes
        ]
        # The last axis has no part in e.
        self._to_column = np.linalg.inv(likelihood.axes[:2, :2])
        self._first = likelihood.origin[:2] + likelihood.axes[:2, :2] @ low
        total = weight * sizes[0]
        mass = total.sum()
        self.mean = complex((total * e).sum() / mass) if mass > 0 else 0j
        spread = float((total * np.abs(e - self.mean) ** 2).sum() / mass) if mass > 0 else 0.0
        self.sigma = max(np.sqrt(spread / 2), 1e-4)
        self.reach = _REACH * self.sigma

    def at(self, unlensed: Complex[Array, " node"], g: complex) -> Float[Array, " node"]:
        """Evaluate where the shear takes galaxies of these ellipticities."""
        value, slope, bend = self.parts(unlensed, g)
        e = _lensed(unlensed, g)
        further = _log_stretch(e, g) - _log_stretch(e, self._about)
        return value + further * slope + 0.5 * further**2 * bend

    def parts(
        self, unlensed: Complex[Array, " node"], g: complex
    ) -> tuple[Float[Array, " node"], ...]:
        """Evaluate there with the sizes of the shear that it is about, and the derivatives by ln alpha."""
        e = _lensed(unlensed, g)
        place = self._to_column @ (np.stack([e.real, e.imag]) - self._first[:, None])
        return tuple(
            map_coordinates(one, place, order=_ORDER, prefilter=False, mode="nearest")
            for one in self._splines
        )


def _nodes(
    prior: EllipticityPrior, surface: _Surface, about: complex
) -> tuple[Complex[Array, " node"], Float[Array, " node"]]:
    """Polar nodes over the population's disc where the likelihood is, with the prior in their weights."""
    centre = (surface.mean - about) / (1 - np.conj(about) * surface.mean)
    middle = abs(centre)
    low, high = max(middle - surface.reach, 0.0), min(middle + surface.reach, prior.maximum)
    radius = low + (high - low) * (_RADII + 1) / 2
    radial = _RADIAL * (high - low) / 2 * prior.modulus_density(radius)
    half = np.pi if surface.reach >= middle else min(np.arcsin(surface.reach / middle), np.pi)
    angle = np.angle(centre) + half * _ANGLES
    nodes = radius[:, None] * np.exp(1j * angle)
    return nodes.ravel(), np.outer(radial, half * _ANGULAR / (2 * np.pi)).ravel()


def _lensed(unlensed: Complex[Array, " node"], g: complex) -> Complex[Array, " node"]:
    return (unlensed + g) / (1 + np.conj(g) * unlensed)


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
