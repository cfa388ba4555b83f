"""Distribution of scale lengths: lognormal about a median that may grow with the flux."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.errors import InputError
from uvshear.typing import Array, Float

UNKNOWN_SIGMA: Final = 1.0
"""Standard deviation of ln(alpha) of a source whose size is an upper limit, or is not known.

In images of 576 galaxies with beams of 3, 6 and 10 arcsec, 76, 253 and 319 of the galaxies that PyBDSF found were not
resolved. The logarithm of their true scale length over half of the upper limit had means of 0.01, -0.12 and -0.29 and
standard deviations of 0.20, 0.22 and 0.28. The prior is wider by a factor of four, because fields of real telescopes
also have active nuclei and stars, which are much smaller."""


@dataclass(frozen=True)
class SizePrior:
    r"""Lognormal prior on the scale length, one element for each source.

    .. math::
        p(\alpha) = \frac{1}{\sqrt{2\pi}\,\sigma\,\alpha}
        \exp\left[-\frac{(\ln\alpha - \mu)^2}{2\sigma^2}\right]

    Parameters
    ----------
    log_median
        Mean mu of ln(alpha / rad).
    sigma
        Standard deviation of ln(alpha).
    """

    log_median: Float[Array, " source"]
    sigma: Float[Array, " source"]

    def __len__(self) -> int:
        return len(self.log_median)

    def select(self, index: Array | slice) -> Self:
        """Return the priors at ``index`` (any one-dimensional numpy index)."""
        return type(self)(self.log_median[index], self.sigma[index])

    def log_density(self, scale_length: Float[Array, "..."]) -> Float[Array, "..."]:
        """Logarithm of the density per radian at ``scale_length`` > 0, whose last axis is the source."""
        log = np.log(scale_length)
        pull = (log - self.log_median) / self.sigma
        return -(pull**2) / 2 - log - np.log(self.sigma) - math.log(2 * math.pi) / 2

    def draw(self, rng: np.random.Generator) -> Float[Array, " source"]:
        """Draw one scale length for each source [rad]."""
        return np.exp(self.log_median + self.sigma * rng.standard_normal(len(self)))


class SizeModel(ABC):
    """Model that gives the prior on the scale lengths."""

    @abstractmethod
    def prior(
        self,
        flux: Float[Array, " source"],
        scale_length: Float[Array, " source"] | None = None,
        scale_length_err: Float[Array, " source"] | None = None,
    ) -> SizePrior:
        """Prior of each source.

        Parameters
        ----------
        flux
            Flux density at 1.4 GHz [Jy].
        scale_length
            Scale length in the catalogue [rad], NaN where it is not known; None if the catalogue has none.
        scale_length_err
            Its standard error [rad], 0 where it is not known; None if the catalogue has none.
        """


@dataclass(frozen=True)
class CatalogueSize(SizeModel):
    r"""Lognormal prior about the scale length in the catalogue, wider where its error is large.

    .. math:: \sigma_i^2 = \sigma^2 + \ln[1 + (\delta\alpha_i/\alpha_i)^2]

    A source whose scale length is not known gets the median of ``SizeFluxRelation`` at its flux, and a standard
    deviation of ``UNKNOWN_SIGMA`` in place of the error.

    Parameters
    ----------
    sigma
        Standard deviation sigma of ln(alpha) about a scale length without error, the same for all sources.
    """

    sigma: float = 0.3136

    def prior(
        self,
        flux: Float[Array, " source"],
        scale_length: Float[Array, " source"] | None = None,
        scale_length_err: Float[Array, " source"] | None = None,
    ) -> SizePrior:
        """Prior of each source about its scale length in the catalogue."""
        if scale_length is None:
            raise InputError(
                "the catalogue has no column 'scale_length', which the prior on the size needs"
            )
        known = np.isfinite(scale_length)
        log_median = np.where(
            known, np.log(np.where(known, scale_length, 1.0)), SizeFluxRelation().log_median(flux)
        )
        error = np.zeros(flux.shape) if scale_length_err is None else scale_length_err
        variance = np.log1p((error / np.where(known, scale_length, 1.0)) ** 2)
        variance = self.sigma**2 + np.where(known, variance, UNKNOWN_SIGMA**2)
        return SizePrior(log_median, np.sqrt(variance))


@dataclass(frozen=True)
class SizeFluxRelation(SizeModel):
    r"""Median scale length as a function of flux density at 1.4 GHz, with lognormal scatter.

    .. math:: \ln[\alpha_\mathrm{med} / \mathrm{arcsec}] = -0.93 + 0.33 \ln[S / \mu\mathrm{Jy}]

    Parameters
    ----------
    intercept, slope
        Coefficients of the line between ln(alpha / arcsec) and ln(S / uJy).
    sigma
        Standard deviation of ln(alpha) at a given flux.

    References
    ----------
    Rivi & Miller 2018, eq. 3 and section 3, which gives sigma as "~ 0.3" (and calls it a variance); 0.3136 is the value
    in ``default_params.h`` of RadioLensfit2.
    """

    intercept: float = -0.93
    slope: float = 0.33
    sigma: float = 0.3136

    def __post_init__(self) -> None:
        if not self.sigma > 0:
            raise InputError(f"size-flux relation: sigma is {self.sigma}; it must be positive")

    def log_median(self, flux: Float[Array, "..."]) -> Float[Array, "..."]:
        """Mean of ln(alpha / rad) at a flux [Jy]."""
        return math.log(ARCSEC) + self.intercept + self.slope * np.log(flux / MICROJANSKY)

    def median(self, flux: Float[Array, "..."]) -> Float[Array, "..."]:
        """Median scale length at a flux [Jy], in radians."""
        return np.exp(self.log_median(flux))

    def prior(
        self,
        flux: Float[Array, " source"],
        scale_length: Float[Array, " source"] | None = None,
        scale_length_err: Float[Array, " source"] | None = None,
    ) -> SizePrior:
        """Prior of each source at its flux [Jy]; the scale length in the catalogue is not used."""
        return SizePrior(self.log_median(flux), np.full(flux.shape, self.sigma))

    def draw(
        self, flux: Float[Array, " source"], rng: np.random.Generator
    ) -> Float[Array, " source"]:
        """Draw one scale length for each flux [rad]."""
        return self.prior(flux).draw(rng)
