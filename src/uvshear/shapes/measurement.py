"""The result of a fit: numbers with their covariance, and one flag."""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Self

import numpy as np

from uvshear.typing import Array, Float


class FitFlag(Enum):
    """Outcome of the fit of a source; the value is a sentence, and the lower-case name appears in tables."""

    OK = "measured"
    OUTSIDE_FIELD = "the source is outside the radius of the field, or so far from the phase centre that images do not"
    " represent it, or smearing and the primary beam leave almost none of its flux"
    BELOW_HORIZON = "the source is 90 degrees or more from the phase centre"
    TOO_LARGE = "the source is too large for images with the resolution of the array; its size was taken from the"
    " catalogue, or follows from its flux"
    POINT_SOURCE = "the catalogue lists a point source (scale_length 0 or profile point): it is subtracted, not"
    " measured"
    NO_DATA = "no visibility within the uv range carries weight"
    NO_PEAK = "the data do not correlate with a galaxy at this position: no positive flux fits"
    UNDETERMINED = "there are too few baselines to determine a position"
    OFF_POSITION = "the best position is outside the prior on the position"
    NOT_CONVERGED = (
        "the maximum of the likelihood, or the extent of the posterior, was not found, or another"
        " major cycle would still change the source noticeably (remaining_change)"
    )
    DUPLICATE = "a brighter source is at the same position; this one was left out"
    CONTAMINATED = (
        "the residual around the source is more than noise: the catalogue lacks a neighbour,"
        " or the profile is wrong"
    )
    NOT_DETECTED = "the data do not show a source: its significance (detection) is below 5"
    UNRESOLVED = (
        "the data do not distinguish the source from a point source: the significance of its extent"
        " (resolved) is below 4"
    )
    UNRELIABLE = "the posterior is narrower than the data and the prior together allow"

    @property
    def word(self) -> str:
        """The flag as it appears in tables."""
        return self.name.lower()

    @property
    def is_fitted(self) -> bool:
        """Whether the fit succeeded; what it found need not be significant."""
        return self in {FitFlag.OK, FitFlag.NOT_DETECTED, FitFlag.UNRESOLVED}


@dataclass(frozen=True)
class GalaxyFit:
    """The most likely galaxy, as a sky model takes it.

    Parameters
    ----------
    flux
        Flux density [Jy].
    offset
        Position relative to the centre of the facet, in l and m [rad].
    ellipticity
        e1 + i e2 in the (l, m) frame.
    scale_length
        Scale length [rad]; zero for a point source.
    snr
        Flux over its error at fixed shape.
    """

    flux: float
    offset: Float[Array, " 2"]
    ellipticity: complex
    scale_length: float
    snr: float

    @property
    def half_width(self) -> float:
        """Distance along the long axis at which the brightness disappears in the noise [rad].

        The long axis has the scale length alpha/(1-|e|); 1 + ln(snr) of these hold all but a fraction 1/snr of the
        flux.
        """
        return (1 + math.log(max(self.snr, 1.0))) * self.scale_length / (1 - abs(self.ellipticity))


@dataclass(frozen=True)
class Quality:
    """How far the measurement of a source can be trusted; NaN where it is not known.

    Parameters
    ----------
    detection
        Significance of the source, sqrt(2 Delta log L) of the most likely galaxy against no source.
    resolved
        Significance of its extent, sqrt(2 Delta log L) of the most likely galaxy against a point.
    error_widening
        Error of e over what it would be if the parameters of the neighbours were known.
    remaining_change
        Change of the model of the source that another major cycle would bring, in units of the noise.
    """

    detection: float = math.nan
    resolved: float = math.nan
    error_widening: float = math.nan
    remaining_change: float = math.nan


@dataclass(frozen=True)
class ShapeMeasurement:
    """Posterior means and standard deviations of one source; NaN where nothing was measured.

    Parameters
    ----------
    ellipticity
        Posterior mean of e1, e2 in the (l, m) frame.
    covariance
        Covariance of e1, e2.
    flux, flux_err
        Flux density at the galaxy's reference frequency, and its error [Jy].
    scale_length, scale_length_err
        Scale length and its error [rad].
    offset, offset_err
        Position relative to the centre of the facet, in l and m, and its errors [rad].
    snr
        Flux over its error at fixed shape.
    best
        The most likely galaxy; None where the fit failed.
    flag
        Outcome of the fit.
    quality
        How far the measurement can be trusted.
    """

    ellipticity: Float[Array, " 2"]
    covariance: Float[Array, "2 2"]
    flux: float
    flux_err: float
    scale_length: float
    scale_length_err: float
    offset: Float[Array, " 2"]
    offset_err: Float[Array, " 2"]
    snr: float
    best: GalaxyFit | None
    flag: FitFlag
    quality: Quality = Quality()

    @classmethod
    def failed(cls, flag: FitFlag) -> Self:
        """Measurement of a source whose fit failed, with the reason."""
        nan = float("nan")
        pair = np.full(2, nan)
        return cls(pair, np.full((2, 2), nan), nan, nan, nan, nan, pair, pair, nan, None, flag)

    @property
    def e_sigma(self) -> float:
        """det(covariance)^(1/4), the "1D standard deviation" of Rivi & Miller 2018, sect. 2.1."""
        (xx, xy), (_, yy) = self.covariance  # numpy's det warns of the NaN of a failure
        return float(max(xx * yy - xy**2, 0.0) ** 0.25)
