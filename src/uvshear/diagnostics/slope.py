"""Slope of a regression of measured on true ellipticity, which shows the multiplicative bias of shapes.

Such a slope depends on the weights of the galaxies. The formal error that Rivi & Miller 2018 quote is that of weights
1/s^2, with s the error of each ellipticity; such a slope is dominated by the few brightest galaxies. The posterior mean
under a flat prior is biased towards zero at a low signal-to-noise ratio, and weights that give faint galaxies more
influence therefore lead to lower slopes of the same shapes.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Float

POPULATION_VARIANCE: Final = 0.07
"""Variance of each component of e in the population, as :func:`population_weights` assumes it."""

Weighting: TypeAlias = Callable[[Float[Array, " source"]], Float[Array, " source"]]
"""Function from the errors s of one component of e to the weights of the galaxies."""


def inverse_variance_weights(error: Float[Array, " source"]) -> Float[Array, " source"]:
    """Weights 1/s^2, probably those of the slopes in Rivi & Miller 2018."""
    return 1 / error**2


def population_weights(error: Float[Array, " source"]) -> Float[Array, " source"]:
    """Weights 1/(s^2 + 0.07), which include the scatter of the population as in an estimate of the shear."""
    return 1 / (error**2 + POPULATION_VARIANCE)


def equal_weights(error: Float[Array, " source"]) -> Float[Array, " source"]:
    """Weights of 1 for all galaxies."""
    return np.ones_like(error)


@dataclass(frozen=True)
class Slope:
    """Slope of a regression through the origin.

    Parameters
    ----------
    value
        The slope b.
    error
        Standard error from the scatter of the galaxies about the line.
    formal_error
        Standard error from the quoted errors alone; 1/sqrt(sum x^2/s^2) for weights 1/s^2.
    effective_number
        Number of galaxies of equal leverage that would give the same error, (sum w x^2)^2 / sum (w x^2)^2.
    """

    value: float
    error: float
    formal_error: float
    effective_number: float


@dataclass(frozen=True)
class Slopes:
    """Slopes of one component of e with three weightings.

    Parameters
    ----------
    inverse_variance
        Slope with weights 1/s^2, probably the definition of Rivi & Miller 2018.
    population
        Slope with weights 1/(s^2 + 0.07).
    unweighted
        Slope with equal weights.
    """

    inverse_variance: Slope
    population: Slope
    unweighted: Slope


def fit_slope(
    true: Float[Array, " source"],
    measured: Float[Array, " source"],
    error: Float[Array, " source"],
    weighting: Weighting = inverse_variance_weights,
) -> Slope:
    r"""Regression of measured on true e_i through the origin.

    .. math::
        b = \frac{\sum w x y}{\sum w x^2},\quad
        \sigma_b^2 = \frac{\sum w^2 x^2 (y - b x)^2}{(\sum w x^2)^2} \frac{n}{n - 1},\quad
        \sigma_\mathrm{formal}^2 = \frac{\sum w^2 x^2 s^2}{(\sum w x^2)^2}

    Parameters
    ----------
    true, measured
        One component of e, x and y; galaxies with a NaN are left out.
    error
        Standard deviations s of ``measured``.
    weighting
        Weights w as a function of s.
    """
    good = np.isfinite(true) & np.isfinite(measured) & np.isfinite(error) & (error > 0)
    x, y, s = true[good], measured[good], error[good]
    w = weighting(s)
    leverage = w * x**2
    norm = float(np.sum(leverage))
    if len(x) < 2:
        raise InputError(f"a slope needs two or more measured galaxies; there are {len(x)}")
    if norm == 0:
        raise InputError(
            "a slope needs galaxies that are not round; all true ellipticities are zero"
        )
    slope = float(np.sum(w * x * y)) / norm
    variance = float(np.sum((w * x * (y - slope * x)) ** 2)) / norm**2
    return Slope(
        value=slope,
        error=math.sqrt(variance * len(x) / (len(x) - 1)),
        formal_error=math.sqrt(float(np.sum((w * x * s) ** 2))) / norm,
        effective_number=norm**2 / float(np.sum(leverage**2)),
    )


def fit_slopes(
    true: Float[Array, " source"],
    measured: Float[Array, " source"],
    error: Float[Array, " source"],
) -> Slopes:
    """Fit the slope of one component of e with each of the three weightings, as :func:`fit_slope` does."""
    return Slopes(
        inverse_variance=fit_slope(true, measured, error, inverse_variance_weights),
        population=fit_slope(true, measured, error, population_weights),
        unweighted=fit_slope(true, measured, error, equal_weights),
    )
