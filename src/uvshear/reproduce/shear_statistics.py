"""Shears and their biases from the weighted mean of ellipticities, as in the paper."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.reproduce.finding import Estimate
from uvshear.reproduce.shape_sample import ShapeSample
from uvshear.typing import Array, Complex, Float


@dataclass(frozen=True)
class MeanBias:
    """Bias of the mean ellipticity, g_measured = (1 + m) g + c, in the frame of (l, m).

    Parameters
    ----------
    m, c
        Multiplicative and additive bias of both components; m is NaN without a shear.
    shears, errors
        Mean ellipticity g1 + i g2 behind each shear, and the standard errors of its components as one complex number.
    galaxies
        Number of galaxies with a measurement.
    """

    m: tuple[Estimate, Estimate]
    c: tuple[Estimate, Estimate]
    shears: Complex[Array, " shear"]
    errors: Complex[Array, " shear"]
    galaxies: int


def mean_bias(sample: ShapeSample, shears: Sequence[complex]) -> MeanBias:
    r"""Fit the bias of the mean ellipticity.

    .. math::
        \hat g_s = \frac{\sum w e}{\sum w},\quad
        m = \frac{\sum_s g_s \hat g_s}{\sum_s g_s^2} - 1,\quad c = \frac{1}{n}\sum_s \hat g_s

    for each component, with shears that add up to zero. Errors are from the scatter among galaxies: all measurements of
    a galaxy are left out together. Without a measurement behind one of the shears all numbers are NaN.

    Parameters
    ----------
    sample
        Measurements behind all shears.
    shears
        The shears in the frame of (l, m).
    """
    numbers, galaxy = np.unique(sample.galaxy, return_inverse=True)
    shape = (len(numbers), len(shears))
    weight = sample.weight
    values = np.where(weight > 0, sample.measured, 0)
    sums, norm = np.zeros(shape, complex), np.zeros(shape)
    np.add.at(sums, (galaxy, sample.shear), weight * values)
    np.add.at(norm, (galaxy, sample.shear), weight)
    total = norm.sum(axis=0)
    if not np.all(total > 0):
        none = Estimate(float("nan"), float("nan"))
        nothing = np.full(len(shears), np.nan + 0j)
        return MeanBias((none, none), (none, none), nothing, nothing, 0)
    found = sums.sum(axis=0) / total
    influence = (sums - found * norm) / total
    n = len(numbers)
    inflation = np.sqrt(n / (n - 1)) if n > 1 else np.nan
    g = np.array(shears)
    results: list[tuple[Estimate, Estimate]] = []
    for part in (np.real, np.imag):
        true, seen, each = part(g), part(found), part(influence)
        length = float(np.sum(true**2))
        slope = true / length if length > 0 else np.full(len(true), np.nan)
        m = float(np.sum(slope * seen)) - 1
        c = float(np.mean(seen))
        results.append(
            (
                Estimate(m, _spread(each @ slope, inflation)),
                Estimate(c, _spread(each.mean(axis=1), inflation)),
            )
        )
    (m1, c1), (m2, c2) = results
    errors = [np.sqrt(np.sum(part(influence) ** 2, axis=0)) for part in (np.real, np.imag)]
    return MeanBias((m1, m2), (c1, c2), found, inflation * (errors[0] + 1j * errors[1]), n)


def _spread(influence: Float[Array, " galaxy"], inflation: float) -> float:
    return float(np.sqrt(np.sum(influence**2)) * inflation)
