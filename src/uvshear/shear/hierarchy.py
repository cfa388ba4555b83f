r"""The population fitted to the very galaxies that are lensed: how large, how scattered in size, how elliptical.

With theta = the intercept of the size-flux relation, the logarithms of its scatter and of the two scales of the
ellipticities' distribution, each galaxy's evidence P(D|g, theta) is that of ``shear.bayesian``; the sum of their
logarithms is climbed by steps

.. math:: \delta\theta = \Big(\sum s_i s_i^T\Big)^{-1} \sum s_i,\quad s_i = \nabla_\theta \ln P(D_i|g, \theta)

(the matrix is that of Berndt, Hall, Hall & Hausman 1974, positive by construction), whose inverse at the end is the
covariance of theta.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from uvshear.errors import InputError
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.shear.bayesian import ShapeLikelihood, UnlensedPopulation, log_evidence
from uvshear.typing import Array, Float

DIFFERENCE = 0.03
"""Of a parameter, to either side, for the gradient."""

LONGEST = 0.4
"""Step of a parameter at most."""

_ROUNDS = 12
_TOLERANCE = 0.1
"""Step over its error at which the climb ends."""


@dataclass(frozen=True)
class FittedPopulation:
    """A population, and the covariance of what was fitted of it, in the order of ``moved``'s parameters."""

    population: UnlensedPopulation
    covariance: Float[Array, "parameter parameter"]


def moved(population: UnlensedPopulation, step: Float[Array, " parameter"]) -> UnlensedPopulation:
    """Take a step in ln of the size, of its scatter, and of the two scales of the ellipticities."""
    size = replace(
        population.size,
        intercept=population.size.intercept + float(step[0]),
        sigma=population.size.sigma * math.exp(step[1]),
    )
    ellipticity = population.ellipticity
    if isinstance(ellipticity, DiscEllipticityPrior):
        ellipticity = replace(
            ellipticity,
            c=ellipticity.c * math.exp(step[2]),
            e0=ellipticity.e0 * math.exp(step[3]),
        )
    return replace(population, size=size, ellipticity=ellipticity)


def fit_population(
    likelihoods: Sequence[ShapeLikelihood], start: UnlensedPopulation, about: complex
) -> FittedPopulation:
    """Fit size and ellipticity of the population to galaxies behind the shear ``about``.

    An ellipticity prior of another kind than ``DiscEllipticityPrior`` stays as it is.
    """
    count = 4 if isinstance(start.ellipticity, DiscEllipticityPrior) else 2
    if len(likelihoods) < 10 * count:
        raise InputError(
            f"{len(likelihoods)} galaxies: a population is fitted to {10 * count} or more"
        )
    population = start
    for _ in range(_ROUNDS):
        scores = _scores(likelihoods, population, about, count)
        covariance = np.linalg.inv(scores.T @ scores)
        step = covariance @ scores.sum(axis=0)
        error = np.sqrt(np.diag(covariance))
        is_there = bool(np.all(np.abs(step) < _TOLERANCE * error))
        step *= min(1.0, LONGEST / float(np.abs(step).max()))
        population = moved(population, np.append(step, np.zeros(4 - count)))
        if is_there:
            return FittedPopulation(population, covariance)
    raise InputError(
        f"no population was found in {_ROUNDS} steps: galaxies of another kind, or too few"
    )


def _scores(
    likelihoods: Sequence[ShapeLikelihood],
    population: UnlensedPopulation,
    about: complex,
    count: int,
) -> Float[Array, "galaxy parameter"]:
    """Gradient of each galaxy's log evidence; zero where the population has no such galaxy."""
    steps = DIFFERENCE * np.eye(4)[:count]
    sides = [(moved(population, step), moved(population, -step)) for step in steps]
    scores = np.array(
        [
            [log_evidence(one, up, about) - log_evidence(one, down, about) for up, down in sides]
            for one in likelihoods
        ]
    )
    return np.where(np.isfinite(scores), scores, 0.0) / (2 * DIFFERENCE)
