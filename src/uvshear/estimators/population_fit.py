r"""Fit of the sizes and ellipticities of the population to the lensed galaxies themselves.

The parameters theta are the intercept of the size-flux relation and the logarithms of its scatter and of the two scales
of the distribution of ellipticities; P(D|g, theta) is the evidence of ``estimators.evidence``. A small sample does not
determine all of them: a hundred galaxies do not show how round the roundest are. Therefore theta has a normal prior
about its first guess, with a standard deviation of w in its logarithm. The sum of the logarithms is maximised by steps

.. math::
    \delta\theta = C\,\Big(\sum s_i - \frac{\theta - \theta_0}{w^2}\Big),\quad
    C = \Big(\sum s_i s_i^T + w^{-2}\Big)^{-1},\quad s_i = \nabla_\theta \ln P(D_i|g, \theta)

where the matrix, that of Berndt, Hall, Hall & Hausman 1974, is positive by construction. At the maximum C is the
covariance of theta.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uvshear.errors import InputError
from uvshear.estimators.evidence import evidence_and_gradient
from uvshear.estimators.population import PopulationRecord, UnlensedPopulation
from uvshear.estimators.shape_likelihood import ShapeLikelihood
from uvshear.galaxy import DiscEllipticityPrior
from uvshear.progress import Meter
from uvshear.typing import Array, Float

LIKENESS = 1.0
"""Standard deviation w of the prior of each parameter, in its logarithm, about the first guess."""

DIFFERENCE = 0.03
"""Step of a parameter of the ellipticities, to either side, in the differences that give the gradient."""

LONGEST = 0.4
"""Longest step of a parameter."""

FORESEEN = 6
"""Usual number of steps."""

_ROUNDS = 20
"""Largest number of steps."""

_TOLERANCE = 0.1
"""Step over its standard error below which the maximum is taken as reached."""

LensedLikelihood: TypeAlias = tuple[ShapeLikelihood, complex]
"""Likelihood of a galaxy's shape, and the shear of the galaxy, both in the frame of (l, m)."""


@dataclass(frozen=True)
class FittedPopulation:
    """A population whose sizes and ellipticities were fitted.

    Parameters
    ----------
    population
        The most probable population.
    covariance
        Covariance of the parameters that were fitted, in the order of :func:`moved`.
    """

    population: UnlensedPopulation
    covariance: Float[Array, "parameter parameter"]

    def record(self) -> PopulationRecord:
        """Return the parameters for a file, with the standard errors of those that were fitted."""
        record = self.population.record()
        errors = [math.sqrt(value) for value in self.covariance.diagonal()]
        places = [
            ("size", "intercept"),
            ("size", "sigma"),
            ("ellipticity", "c"),
            ("ellipticity", "e0"),
        ]
        for k, (error, (part, name)) in enumerate(zip(errors, places, strict=False)):
            # All parameters but the first, the intercept, were fitted as logarithms.
            record[part][f"{name}_err"] = error * (1.0 if k == 0 else record[part][name])
        return record


def moved(population: UnlensedPopulation, step: Float[Array, " parameter"]) -> UnlensedPopulation:
    """Return the population after a step in ln of the size, of its scatter, and of both scales of the ellipticities.

    A distribution of ellipticities other than ``DiscEllipticityPrior`` has no such scales and stays as it is.
    """
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
    galaxies: Sequence[LensedLikelihood],
    start: UnlensedPopulation,
    meter: Meter | None = None,
) -> FittedPopulation:
    """Fit the sizes and ellipticities of the population to galaxies, each with its shear.

    Parameters
    ----------
    start
        First guess of the population, about which the parameters have their prior. Its fluxes are not fitted, nor are
        ellipticities of another kind than ``DiscEllipticityPrior``.
    meter
        Meter that counts the processed galaxies.

    Raises
    ------
    InputError
        There are fewer than ten galaxies for each parameter, or no maximum was found.
    """
    count = parameter_count(start)
    if len(galaxies) < 10 * count:
        raise InputError(
            f"{len(galaxies)} galaxies are too few to fit a population; {10 * count} or more are needed"
        )
    meter = meter or Meter(None)
    meter.expect(FORESEEN * len(galaxies))
    theta = np.zeros(count)
    for _ in range(_ROUNDS):
        scores = population_scores(galaxies, moved(start, theta), meter)
        covariance = np.linalg.inv(scores.T @ scores + np.eye(count) / LIKENESS**2)
        step = covariance @ (scores.sum(axis=0) - theta / LIKENESS**2)
        is_there = bool(np.all(np.abs(step) < _TOLERANCE * np.sqrt(np.diag(covariance))))
        theta = theta + step * min(1.0, LONGEST / float(np.abs(step).max()))
        if is_there:
            return FittedPopulation(moved(start, theta), covariance)
    raise InputError(
        f"the fit of the population did not converge in {_ROUNDS} steps: the galaxies are too few, or differ too"
        " much from the first guess"
    )


def parameter_count(population: UnlensedPopulation) -> int:
    """Return the number of parameters of a population that can be fitted."""
    return 4 if isinstance(population.ellipticity, DiscEllipticityPrior) else 2


def population_scores(
    galaxies: Sequence[LensedLikelihood], population: UnlensedPopulation, meter: Meter
) -> Float[Array, "galaxy parameter"]:
    """Return the gradient of each galaxy's log evidence; zero where the population has no such galaxy."""
    count = parameter_count(population)
    # The derivatives by the two parameters of the size need no differences.
    steps = DIFFERENCE * np.eye(count)[2:]
    sides = [
        (moved(population, step).ellipticity, moved(population, -step).ellipticity)
        for step in steps
    ]
    scores = np.empty((len(galaxies), count))
    for score, (likelihood, shear) in zip(scores, galaxies, strict=True):
        _, score[:] = evidence_and_gradient(likelihood, population, shear, sides, 2 * DIFFERENCE)
        meter.add()
    return scores
