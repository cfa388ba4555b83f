"""Weight of an ellipticity in a mean of ellipticities."""

import numpy as np

from uvshear.galaxy import EllipticityPrior
from uvshear.typing import Array, Float


def lensfit_weight(
    e_sigma: Float[Array, " source"], population: EllipticityPrior
) -> Float[Array, " source"]:
    r"""Inverse variance of an ellipticity as an estimate of shear; 0 where nothing was measured.

    .. math:: w = \left[\frac{s^2 e_\mathrm{max}^2}{e_\mathrm{max}^2 - 2 s^2}
              + \sigma_\mathrm{pop}^2\right]^{-1}

    with s the standard deviation of the measurement; the weight is zero for s^2 >= e_max^2/2. A measurement without
    information has the standard deviation of the prior, 0.475 for a disc of radius 0.95, and still gets a tenth of the
    largest weight. Such galaxies should be excluded by a cut in the signal-to-noise ratio.

    Parameters
    ----------
    e_sigma
        Standard deviation of each component of the ellipticity.
    population
        Distribution of intrinsic ellipticities, with its variance and its maximum e_max.

    References
    ----------
    Miller et al. 2013, MNRAS 429, 2858, eq. 8.
    """
    variance, largest = e_sigma**2, population.maximum**2
    room = largest - 2 * variance
    is_measured = np.isfinite(e_sigma) & (room > 0)
    noise = variance * largest / np.where(is_measured, room, 1.0)
    return np.where(is_measured, 1 / (noise + population.population_variance), 0.0)
