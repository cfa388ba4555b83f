"""Distribution of scale lengths: lognormal about a median that may grow with the flux."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.errors import InputError
from uvshear.typing import Array, Float


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
    ) -> SizePrior:
        """Prior of each source, given its flux at 1.4 GHz [Jy] and its scale length in the catalogue [rad]."""


@dataclass(frozen=True)
class CatalogueSize(SizeModel):
    """Lognormal prior about the scale length in the catalogue.

    Parameters
    ----------
    sigma
        Standard deviation of ln(alpha), the same for all sources.
    """

    sigma: float = 0.3136

    def prior(
        self,
        flux: Float[Array, " source"],
        scale_length: Float[Array, " source"] | None = None,
    ) -> SizePrior:
        """Prior of each source about its scale length in the catalogue."""
        if scale_length is None:
            raise InputError(
                "the catalogue has no column 'scale_length', which the prior on the size needs"
            )
        return SizePrior(np.log(scale_length), np.full(flux.shape, self.sigma))


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
    ) -> SizePrior:
        """Prior of each source at its flux [Jy]; the scale length in the catalogue is not used."""
        return SizePrior(self.log_median(flux), np.full(flux.shape, self.sigma))

    def draw(
        self, flux: Float[Array, " source"], rng: np.random.Generator
    ) -> Float[Array, " source"]:
        """Draw one scale length for each flux [rad]."""
        return self.prior(flux).draw(rng)
