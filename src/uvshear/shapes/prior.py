"""What is known of a galaxy before its fit."""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from uvshear.galaxy import EllipticityPrior, FlatEllipticityPrior
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class ShapePrior:
    """Prior of one source; its flux is uniform from 0.

    Parameters
    ----------
    log_scale_length
        Mean of ln(scale length / rad).
    log_scale_length_sigma
        Its standard deviation.
    position_radius
        The position is uniform within this distance of the facet's centre [rad]; None stands for one
        width (Gaussian sigma) of the cross-correlation's peak.
    ellipticity
        Density over the plane of e; flat over |e| < 0.95 unless given. Of the posterior, not of its maximum.
    ellipticity_sigma, position_sigma
        Standard deviations of one component of e, and of l or m about the facet's centre [rad]: of the maximum, not
        of the posterior. Infinite for a measurement; finite for a sky model, whose sources shall not fit the noise
        that their neighbours are measured by.
    flux, flux_sigma
        Mean and standard deviation of the flux [Jy]: of a sky model's maximum alone, as these.
    """

    log_scale_length: float
    log_scale_length_sigma: float
    position_radius: float | None = None
    ellipticity: EllipticityPrior = field(default_factory=FlatEllipticityPrior)
    ellipticity_sigma: float = math.inf
    position_sigma: float = math.inf
    flux: float = 0.0
    flux_sigma: float = math.inf

    @property
    def measured(self) -> "ShapePrior":
        """The prior of a measurement, without what the sky model alone has."""
        free = math.inf
        return replace(self, ellipticity_sigma=free, position_sigma=free, flux_sigma=free)

    def penalty(self, fit: GalaxyFit) -> float:
        """Minus twice the log density of a sky model's source, but for a constant."""
        total = (abs(fit.ellipticity) / self.ellipticity_sigma) ** 2
        total += ((fit.flux - self.flux) / self.flux_sigma) ** 2
        total += float(np.sum((fit.offset / self.position_sigma) ** 2))
        if fit.scale_length > 0:
            total += self._size_deviation(fit) ** 2
        return total

    def pull(self, fit: GalaxyFit) -> tuple[Float[Array, " 6"], Float[Array, " 6"]]:
        """Gradient of the log density by flux, e1, e2, ln alpha, l, m, and its precision.

        A point source has no shape: the three rows stand for themselves.
        """
        by_flux = self.flux_sigma**-2
        by_e, by_x = self.ellipticity_sigma**-2, self.position_sigma**-2
        if fit.scale_length > 0:
            by_size = self.log_scale_length_sigma**-2
            away = self._size_deviation(fit) * self.log_scale_length_sigma
            shape = (fit.ellipticity.real, fit.ellipticity.imag, away)
            precision = np.array([by_flux, by_e, by_e, by_size, by_x, by_x])
        else:
            shape = (0.0, 0.0, 0.0)
            precision = np.array([by_flux, 1.0, 1.0, 1.0, by_x, by_x])
        return -precision * np.array([fit.flux - self.flux, *shape, *fit.offset]), precision

    def _size_deviation(self, fit: GalaxyFit) -> float:
        away = math.log(fit.scale_length) - self.log_scale_length
        return away / self.log_scale_length_sigma
