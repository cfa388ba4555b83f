"""The fit of one facet: the most likely galaxy, and the posterior of its shape."""

import math
from dataclasses import replace

import numpy as np

from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.numerics.symmetric import smallest_eigenvalue
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.maximum import (
    BestFit,
    maximise_likelihood,
    search_radius,
    shape_covariance,
)
from uvshear.shapes.measurement import FitFlag, GalaxyFit, ShapeMeasurement
from uvshear.shapes.posterior import PosteriorSamples, sample_posterior
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Float

FLOAT32_SNR = 150.0
"""Signal-to-noise ratio above which differences of log L need double precision. The rounding of single precision moves
e by 1e-4 of its error at a ratio of 150, by 5e-4 at 300, 3e-3 at 600, and 0.4 at 2000."""

NARROW = 0.5
"""Smallest credible width of a posterior, over the width that the Fisher matrix and the prior give together.
Isolated galaxies have at least 0.77, at signal-to-noise ratios from 3 to 2000 and on either kind of facet."""

SINGULAR = 1e-9
"""Smallest eigenvalue of the Fisher matrix of the position, scaled to a unit diagonal, that counts as information."""


def fit_galaxy(
    facet: Facet, prior: ShapePrior, profile: Profile, start: GalaxyFit | None = None
) -> GalaxyFit | None:
    """Most likely galaxy, for a sky model; None where no credible galaxy was found.

    Parameters
    ----------
    facet
        Facet from which all other sources are subtracted.
    prior
        Prior of the source's shape, with the terms of a sky model.
    profile
        Brightness profile.
    start
        Galaxy to start from; without one the fit looks for the highest peak.
    """
    if not _has_data(facet):
        return None
    correlator = Correlator(facet, profile)
    best = maximise_likelihood(correlator, prior, start)
    if (
        best is None
        or not is_determined(best)
        or convergence_flag(best, correlator, prior) is not FitFlag.OK
    ):
        return None
    return _galaxy(best, correlator)


def measure_shape(
    facet: Facet,
    prior: ShapePrior,
    profile: Profile,
    start: GalaxyFit | None = None,
    *,
    information_fraction: float = 1.0,
) -> ShapeMeasurement:
    """Posterior mean and covariance of the ellipticity, with flux, position and size marginalised.

    Parameters
    ----------
    facet
        Facet from which all other sources are subtracted.
    prior
        Prior of the source's shape.
    profile
        Brightness profile.
    start
        Galaxy to start from; without one the fit looks for the highest peak.
    information_fraction
        Fraction of the facet's information on the shape that is used: less than one where neighbours are not known as
        well as their subtraction assumes, or where the weights claim less noise than there is.
    """
    if not _has_data(facet):
        return ShapeMeasurement.failed(FitFlag.NO_DATA)
    correlator = Correlator(facet, profile)
    best = maximise_likelihood(correlator, prior, start)
    if best is None:
        return ShapeMeasurement.failed(FitFlag.NO_PEAK)
    if not is_determined(best):
        return ShapeMeasurement.failed(FitFlag.UNDETERMINED)
    if best.snr > FLOAT32_SNR:
        correlator = Correlator(facet, profile, np.float64)
        best = maximise_likelihood(correlator, prior, _galaxy(best, correlator)) or best
    samples = sample_posterior(correlator, prior, best, information_fraction)
    if not np.all(np.isfinite(samples.probability)):
        return ShapeMeasurement.failed(FitFlag.NOT_CONVERGED)
    flag = (
        convergence_flag(best, correlator, prior) if samples.is_covered else FitFlag.NOT_CONVERGED
    )
    shape = _summarise(samples, correlator, best, flag)
    if flag is FitFlag.OK and shape.e_sigma < NARROW * _expected_e_sigma(best, prior):
        return replace(shape, best=None, flag=FitFlag.UNRELIABLE)
    return shape


def _galaxy(best: BestFit, correlator: Correlator) -> GalaxyFit:
    return GalaxyFit(
        flux=best.flux * correlator.flux_unit,
        offset=best.position * correlator.length,
        ellipticity=best.ellipticity,
        scale_length=math.exp(best.log_scale_length),
        snr=best.snr,
    )


def is_determined(best: BestFit) -> bool:
    """Whether the visibilities determine a position; those of a single baseline do not."""
    return smallest_eigenvalue(best.position_information) > SINGULAR


def _has_data(facet: Facet) -> bool:
    return len(facet.uv) > 0 and float(np.sum(facet.power)) > 0


def convergence_flag(best: BestFit, correlator: Correlator, prior: ShapePrior) -> FitFlag:
    """Return OK if the maximum was found, and lies within the prior on the position."""
    if not best.has_converged:
        return FitFlag.NOT_CONVERGED
    # The lattice of starts reaches the edge of the prior, and the climb may go a little beyond it.
    if np.hypot(*best.position) > 1.5 * search_radius(correlator, prior):
        return FitFlag.OFF_POSITION
    return FitFlag.OK


def _expected_e_sigma(best: BestFit, prior: ShapePrior) -> float:
    """det(covariance of e)^(1/4) from the Fisher matrix of the best fit and the variance of the prior."""
    information = np.linalg.inv(shape_covariance(best)[:2, :2])
    information += np.eye(2) / prior.ellipticity.population_variance
    return float(np.linalg.det(information)) ** -0.25


def _summarise(
    samples: PosteriorSamples, correlator: Correlator, best: BestFit, flag: FitFlag
) -> ShapeMeasurement:
    """First and second moments of the posterior in jansky and radians."""
    given, p = samples.given_shape, samples.probability
    e, covariance = _moments(
        np.stack([samples.ellipticity.real, samples.ellipticity.imag], axis=-1), p
    )
    size, size_variance = _moments(np.exp(samples.log_scale_length)[:, None], p)
    flux, flux_variance = _moments(given.flux[:, None], p)
    offset, offset_covariance = _moments(given.offset + correlator.centre, p)
    flux_variance = flux_variance[0, 0] + p @ given.flux_variance
    offset_variance = np.diag(offset_covariance) + p @ given.offset_variance
    return ShapeMeasurement(
        ellipticity=e,
        covariance=covariance,
        flux=float(flux[0]) * correlator.flux_unit,
        flux_err=math.sqrt(flux_variance) * correlator.flux_unit,
        scale_length=float(size[0]),
        scale_length_err=math.sqrt(size_variance[0, 0]),
        offset=offset * correlator.length,
        # Where all nodes are at one place, rounding may leave a variance below zero.
        offset_err=np.sqrt(np.maximum(offset_variance, 0)) * correlator.length,
        snr=float(flux[0] * math.sqrt(p @ given.norm)),
        best=_galaxy(best, correlator) if flag is FitFlag.OK else None,
        flag=flag,
    )


def _moments(
    values: Float[Array, "sample n"], probability: Float[Array, " sample"]
) -> tuple[Float[Array, " n"], Float[Array, "n n"]]:
    mean = probability @ values
    deviation = values - mean
    return mean, (deviation * probability[:, None]).T @ deviation
