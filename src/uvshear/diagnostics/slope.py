"""The slope of measured against true ellipticity: how far shapes are from unbiased."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Float

SCATTER: Final = 0.07
"""Variance of one component of e over the population, as the weights take it."""


@dataclass(frozen=True)
class Slope:
    """A slope through the origin and its standard error."""

    value: float
    error: float


def fit_slope(
    true: Float[Array, " source"],
    measured: Float[Array, " source"],
    error: Float[Array, " source"] | None = None,
) -> Slope:
    r"""Regression of measured on true e_i through the origin.

    .. math::
        b = \frac{\sum w x y}{\sum w x^2},\quad w = \frac{1}{s^2 + 0.07},\quad
        \sigma_b^2 = \frac{\sum w^2 x^2 (y - b x)^2}{(\sum w x^2)^2} \frac{n}{n - 1}

    Parameters
    ----------
    true, measured
        One component of e; galaxies with a NaN are left out.
    error
        s, the standard deviation of ``measured``; None weighs all alike.
    """
    weight = np.ones_like(true) if error is None else 1 / (error**2 + SCATTER)
    good = np.isfinite(true) & np.isfinite(measured) & np.isfinite(weight)
    x, y, w = true[good], measured[good], weight[good]
    norm = float(np.sum(w * x**2))
    if len(x) < 2 or norm == 0:
        raise InputError(f"a slope of {len(x)} galaxies; two or more measured ones are needed")
    slope = float(np.sum(w * x * y)) / norm
    variance = float(np.sum((w * x * (y - slope * x)) ** 2)) / norm**2
    return Slope(slope, float(np.sqrt(variance * len(x) / (len(x) - 1))))
