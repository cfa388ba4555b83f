"""The cost of a weighting: signal-to-noise ratio of sources, and information on their shapes."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form_derivatives, quadratic_form_of
from uvshear.interferometer.baseline_map import BaselineMap
from uvshear.typing import Array, Float

WORST = 1e8
"""Condition number above which flux, size and ellipticity cannot be separated."""


@dataclass(frozen=True)
class WeightingLoss:
    """Signal-to-noise ratios and information with a weighting, relative to natural weights.

    Parameters
    ----------
    snr_point, snr_galaxy
        Fraction of the signal-to-noise ratio of a point source, and of a galaxy measured with its own model.
    information
        Fraction of the information, 1/variance, on e1 and on e2 of the galaxy with its flux and size free.
    variance_over_beam
        Variance of its ellipticity over the variance that follows from the weights if they are taken as 1/sigma^2.
    """

    snr_point: float
    snr_galaxy: float
    information: tuple[float, float]
    variance_over_beam: float


def weighting_loss(
    cells: BaselineMap, scale_length: float, profile: Profile, ellipticity: complex = 0j
) -> WeightingLoss:
    r"""Compute the loss for a galaxy of a scale length [rad] from the covariance of linear estimates.

    With D the derivatives of the model with respect to flux, ellipticity and ln(scale length), natural weights w and
    factors T,

    .. math::
        \mathrm{cov}_T = H^{-1} J H^{-1},\quad H = \sum w T D D^T,\ J = \sum w T^2 D D^T,\quad
        \mathrm{cov} = \left(\sum w D D^T\right)^{-1}

    Positions are left out, because the derivative of a model with respect to its position is imaginary and the others
    are real.

    Raises
    ------
    InputError
        The weighted baselines do not determine flux, size and ellipticity.
    """
    derivatives = _derivatives(cells, scale_length, profile, ellipticity)
    natural, once, twice = (
        (derivatives * weight) @ derivatives.T
        for weight in (cells.weight, cells.weighted_sum, cells.weighted_sum_of_squares)
    )
    # Scaled by the error of each parameter alone, so that the condition number has no units.
    alone = np.sqrt(np.diag(once))
    if not np.all(alone > 0) or np.linalg.cond(once / np.outer(alone, alone)) > WORST:
        raise InputError(
            f"the weighted baselines do not determine the shape of a galaxy of scale length"
            f" {scale_length / ARCSEC:.3g} arcsec; a wider uv range, or another weighting, is needed"
        )
    by_beam = np.linalg.inv(once)
    covariance = by_beam @ twice @ by_beam
    best = np.diag(np.linalg.inv(natural))[1:3]
    variance = np.diag(covariance)[1:3]
    model = derivatives[0]
    information = best / variance
    return WeightingLoss(
        snr_point=_snr(cells, np.ones_like(model)),
        snr_galaxy=_snr(cells, model),
        information=(float(information[0]), float(information[1])),
        variance_over_beam=float(variance.sum() / np.diag(by_beam)[1:3].sum()),
    )


def _snr(cells: BaselineMap, model: Float[Array, " cell"]) -> float:
    """Fraction of the signal-to-noise ratio of a model's flux that is left."""
    natural, once, twice = (
        float(np.sum(weight * model**2))
        for weight in (cells.weight, cells.weighted_sum, cells.weighted_sum_of_squares)
    )
    return once / math.sqrt(natural * twice)


def _derivatives(
    cells: BaselineMap, scale_length: float, profile: Profile, ellipticity: complex
) -> Float[Array, "4 cell"]:
    """Differentiate the model by flux, e1, e2, ln(scale length), for unit flux."""
    squares = 4 * math.pi**2 * np.stack([cells.u**2, cells.u * cells.v, cells.v**2])
    q = quadratic_form_of(ellipticity, scale_length) @ squares
    by_form = quadratic_form_derivatives(ellipticity, scale_length) @ squares
    return np.concatenate([profile.envelope(q)[None], profile.envelope_slope(q) * by_form])
