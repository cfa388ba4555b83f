"""How large galaxies are: lognormal about a median that grows with the flux."""

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
    r"""Lognormal prior of scale lengths, one element a source.

    .. math::
        p(\alpha) = \frac{1}{\sqrt{2\pi}\,\sigma\,\alpha}
        \exp\left[-\frac{(\ln\alpha - \mu)^2}{2\sigma^2}\right]

    Parameters
    ----------
    log_median
        mu, the mean of ln(alpha / rad).
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
        """Log of the density per radian at ``scale_length`` > 0, whose last axis is the source."""
        log = np.log(scale_length)
        pull = (log - self.log_median) / self.sigma
        return -(pull**2) / 2 - log - np.log(self.sigma) - math.log(2 * math.pi) / 2

    def draw(self, rng: np.random.Generator) -> Float[Array, " source"]:
        """Draw one scale length a source [rad]."""
        return np.exp(self.log_median + self.sigma * rng.standard_normal(len(self)))


class SizeModel(ABC):
    """Where the prior on the scale length comes from."""

    @abstractmethod
    def prior(
        self,
        flux: Float[Array, " source"],
        scale_length: Float[Array, " source"] | None = None,
    ) -> SizePrior:
        """Prior of each source, given its flux at 1.4 GHz [Jy] and its size in the catalogue [rad]."""


@dataclass(frozen=True)
class CatalogueSize(SizeModel):
    """Lognormal about the catalogue's own scale length, with a common scatter ``sigma`` of its logarithm."""

    sigma: float = 0.3136

    def prior(
        self,
        flux: Float[Array, " source"],
        scale_length: Float[Array, " source"] | None = None,
    ) -> SizePrior:
        """Prior of each source's scale length about the catalogue's."""
        if scale_length is None:
            raise InputError(
                "the catalogue has no column 'scale_length' to take the size prior from"
            )
        return SizePrior(np.log(scale_length), np.full(flux.shape, self.sigma))


@dataclass(frozen=True)
class SizeFluxRelation(SizeModel):
    r"""Median scale length against flux density at 1.4 GHz, with lognormal scatter.

    .. math:: \ln[\alpha_\mathrm{med} / \mathrm{arcsec}] = -0.93 + 0.33 \ln[S / \mu\mathrm{Jy}]

    Parameters
    ----------
    intercept, slope
        Of the line between ln(alpha / arcsec) and ln(S / uJy).
    sigma
        Standard deviation of ln(alpha) at a flux.

    References
    ----------
    Rivi & Miller 2018, eq. 3 and section 3, which gives sigma "~ 0.3" (and calls it a variance);
    0.3136 is the value of RadioLensfit2's ``default_params.h``.
    """

    intercept: float = -0.93
    slope: float = 0.33
    sigma: float = 0.3136

    def __post_init__(self) -> None:
        if not self.sigma > 0:
            raise InputError(f"size-flux relation: sigma is {self.sigma}; more than 0 is needed")

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
        """Prior of each source's scale length at its flux [Jy], whatever size the catalogue has."""
        return SizePrior(self.log_median(flux), np.full(flux.shape, self.sigma))

    def draw(
        self, flux: Float[Array, " source"], rng: np.random.Generator
    ) -> Float[Array, " source"]:
        """Draw one scale length a flux [rad]."""
        return self.prior(flux).draw(rng)
