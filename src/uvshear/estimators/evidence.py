r"""The probability of a galaxy's data given the shear, its gradient and its curvature.

Each galaxy has a likelihood L over (e, ln alpha), marginalised over position and flux. Galaxies with a shear g are
galaxies of the unlensed population, mapped by the lens. With

.. math::
    e_s = \frac{e - g}{1 - g^* e},\quad r = \frac{1 - |g|^2}{|1 - g^* e|^2},\quad
    \ln\alpha_s = \ln\alpha + \tfrac12 \ln r

the density of (e, ln alpha, S) is p(e_s) r^2 p(ln alpha_s | S) p(S), where p(e) is per unit area of the disc, and

.. math::
    P(D|g) = \int L\, p,\quad q = \nabla \ln P,\quad h = -\nabla\nabla \ln P,\quad
    \hat g = g_0 + \Big(\sum h\Big)^{-1} \sum q

where q and h are taken at g_0, which is then set to the estimate (Bernstein & Armstrong 2014, eq. 8 to 12, about g = 0;
Sheldon 2014). An expansion about zero would not be enough: the core of the distribution of ellipticities is 0.07 wide,
so that the third order in the shear gives m = 0.01 at \|g\| = 0.03.

A likelihood that covers the core of the population, its kink at zero or its maximum is integrated over the unlensed
e_s, with nodes that are chosen for these places; g then moves the smooth likelihood (``polar_integral``). A likelihood
that keeps clear of them is summed over its own lattice, and g moves the population (``lattice_integral``).
"""

import math
from collections.abc import Sequence

import numpy as np

from uvshear.estimators.lattice_integral import LatticeIntegral, is_clear
from uvshear.estimators.polar_integral import PolarIntegral
from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.shape_integral import ShapeIntegral, WeightedLattice
from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.galaxy import EllipticityPrior
from uvshear.typing import Array, Float

STEP = 0.1
"""Step of the differences in g over the standard deviation of e, up to ``WIDEST_STEP``."""

WIDEST_STEP = 0.01
"""Largest step of the differences in g."""

RINGING = 0.05
"""Ratio of the negative part of the evidence to the evidence above which a galaxy counts as uninformative.

Where the likelihood of a galaxy lies almost entirely outside the population's disc of ellipticities, and is lower by
orders of magnitude inside, the integral is dominated by the ringing of the spline. One measurement of 63 000 had a
curvature of thousands; among 1214 others the ratio never exceeded 0.006."""

_FARTHEST = 4.0
"""Standard deviations of e beyond which the likelihood is not known: a galaxy so far outside the population's disc does
not occur in it. Such galaxies would have a curvature of 1/sigma^2, and a few would outweigh all others."""


def evidence_and_gradient(
    likelihood: ShapeLikelihood,
    population: UnlensedPopulation,
    about: complex,
    sides: Sequence[tuple[EllipticityPrior, EllipticityPrior]] = (),
    difference: float = 1.0,
) -> tuple[float, Float[Array, " parameter"]]:
    r"""Ln P(D|g) of one galaxy, up to a constant that no population changes, and its gradient by the population.

    Sizes are lognormal. With t = (ln alpha_s - mu)/sigma, the derivatives by mu and ln sigma are the averages of
    t/sigma and t^2 - 1 over the posterior of the galaxy. The derivatives by ln alpha, which a shear needs in any case,
    give both.

    Parameters
    ----------
    about
        Shear of the galaxy, in the frame of its likelihood.
    sides
        Pairs of ellipticity priors to either side of the population's, with the same maximum: one pair for each
        parameter of the ellipticity prior.
    difference
        Difference of the parameter between the members of a pair.

    Returns
    -------
    log_evidence
        Log evidence; -inf where the population has no such galaxy.
    gradient
        Derivatives by ln of the median size, by ln of its scatter, and by the parameters of ``sides``; zeros where the
        population has no such galaxy.
    """
    nothing = -math.inf, np.zeros(2 + len(sides))
    found = _integral(likelihood, population, about)
    if found is None:
        return nothing
    integral, _ = found
    value, slope, bend = integral.parts(about)
    weight = integral.weight(population.ellipticity, about)
    evidence = float(weight @ value)
    if _rings(weight * value) or not evidence > 0:
        return nothing
    gradient = [-weight @ slope, population.size.sigma**2 * (weight @ bend)]
    for up, down in sides:
        change = integral.weight(up, about) - integral.weight(down, about)
        gradient.append(change @ value / difference)
    return math.log(evidence), np.array(gradient) / evidence


def gradient_and_curvature(
    likelihood: ShapeLikelihood, population: UnlensedPopulation, about: complex
) -> tuple[Float[Array, " 2"], Float[Array, "2 2"]]:
    """Return q and h of one galaxy at the shear ``about``; both are zero where the population has no such galaxy."""
    nothing = np.zeros(2), np.zeros((2, 2))
    found = _integral(likelihood, population, about)
    if found is None:
        return nothing
    integral, sigma = found
    prior = population.ellipticity
    terms = integral.terms(prior, about)
    p = float(terms.sum())
    if _rings(terms) or not p > 0:
        return nothing
    step = min(STEP * sigma, WIDEST_STEP)
    offsets = step * np.array([1, -1, 1j, -1j, 1 + 1j, -1 - 1j, 1 - 1j, -1 + 1j])
    evidence = [float(integral.terms(prior, complex(about + each)).sum()) for each in offsets]
    right, left, up, down, ne, sw, se, nw = evidence
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
    """Tell whether the evidence is dominated by the ringing of the spline, judging by its negative part."""
    return bool(-parts[parts < 0].sum() > RINGING * parts.sum())


def _integral(
    likelihood: ShapeLikelihood, population: UnlensedPopulation, about: complex
) -> tuple[ShapeIntegral, float] | None:
    """Return a galaxy's integral and its standard deviation of e; None where the population has no such galaxy."""
    lattice = WeightedLattice.weighted(likelihood, population, about)
    if lattice is None:
        return None
    maximum = population.ellipticity.maximum
    middle = abs(lattice.unlensed_mean)
    if middle > maximum and middle - _FARTHEST * lattice.deviations()[0] > maximum:
        return None
    if is_clear(lattice, maximum):
        return LatticeIntegral(lattice), lattice.sigma
    return PolarIntegral(lattice, maximum), lattice.sigma
