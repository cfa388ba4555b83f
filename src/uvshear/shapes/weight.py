"""How much an ellipticity counts."""

import numpy as np

from uvshear.galaxy import EllipticityPrior
from uvshear.typing import Array, Float


def lensfit_weight(
    e_sigma: Float[Array, " source"], population: EllipticityPrior
) -> Float[Array, " source"]:
    r"""Inverse variance of an ellipticity as an estimate of shear; 0 where nothing was measured.

    .. math:: w = \left[\frac{s^2 e_\mathrm{max}^2}{e_\mathrm{max}^2 - 2 s^2}
              + \sigma_\mathrm{pop}^2\right]^{-1}

    with s the measurement's standard deviation; zero from s^2 = e_max^2/2 on. A measurement that says nothing
    has the prior's own s, 0.475 for a disc of radius 0.95, and a tenth of the largest weight: leave such
    galaxies out by their signal-to-noise ratio.

    References
    ----------
    Miller et al. 2013, MNRAS 429, 2858, eq. 8.
    """
    variance, largest = e_sigma**2, population.maximum**2
    room = largest - 2 * variance
    is_measured = np.isfinite(e_sigma) & (room > 0)
    noise = variance * largest / np.where(is_measured, room, 1.0)
    return np.where(is_measured, 1 / (noise + population.population_variance), 0.0)
