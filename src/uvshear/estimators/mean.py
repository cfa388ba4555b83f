"""Shear as the weighted mean of ellipticities, the estimator of Rivi & Miller 2018."""

from dataclasses import dataclass

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Complex, Float


@dataclass(frozen=True)
class ShearEstimate:
    """Reduced shear with its standard errors, from ``n`` galaxies; in the axes (l East, m North) of their e."""

    g1: float
    g1_err: float
    g2: float
    g2_err: float
    n: int
    estimator: str


def weighted_mean_shear(
    ellipticity: Complex[Array, " source"],
    weight: Float[Array, " source"],
    rng: np.random.Generator,
    *,
    bootstraps: int = 1000,
) -> ShearEstimate:
    r"""Mean ellipticity, g = sum w e / sum w; its error is the scatter over bootstrap resamples.

    Noise biases it (Rivi & Miller 2018, Table 2: m about -0.1 at SNR >= 10).
    """
    used = np.isfinite(ellipticity) & (weight > 0)
    e, w = ellipticity[used], weight[used]
    if len(e) < 2:
        raise InputError(f"the shear of {len(e)} galaxies; two or more with weight are needed")
    mean = np.sum(w * e) / np.sum(w)
    resampled = np.empty(bootstraps, complex)
    for i in range(bootstraps):
        drawn = rng.integers(len(e), size=len(e))
        resampled[i] = np.sum(w[drawn] * e[drawn]) / np.sum(w[drawn])
    return ShearEstimate(
        g1=float(mean.real),
        g1_err=float(resampled.real.std(ddof=1)),
        g2=float(mean.imag),
        g2_err=float(resampled.imag.std(ddof=1)),
        n=len(e),
        estimator="mean",
    )
