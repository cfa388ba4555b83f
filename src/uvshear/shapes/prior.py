"""Prior knowledge of one galaxy."""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from uvshear.galaxy import EllipticityPrior, FlatEllipticityPrior
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class ShapePrior:
    """Prior of one source; its flux is uniform from zero.

    The last four parameters are Gaussian terms of a sky model, whose sources must not fit the noise of the data in
    which their neighbours are measured. They affect the most likely galaxy only, and are infinitely wide for a
    measurement.

    Parameters
    ----------
    log_scale_length
        Mean of ln(scale length / rad).
    log_scale_length_sigma
        Standard deviation of ln(scale length).
    position_radius
        Distance from the facet's centre within which the position is uniform [rad]; None stands for one width
        (Gaussian sigma) of the peak of the cross-correlation.
    ellipticity
        Density over the plane of e, flat over |e| < 0.95 unless given; it affects the posterior and not the most likely
        galaxy.
    ellipticity_sigma
        Standard deviation of each component of e for a sky model.
    position_sigma
        Standard deviation of l and of m about the facet's centre for a sky model [rad].
    flux, flux_sigma
        Mean and standard deviation of the flux for a sky model [Jy].
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
        """The prior of a measurement, without the terms of a sky model."""
        none = math.inf
        return replace(self, ellipticity_sigma=none, position_sigma=none, flux_sigma=none)

    def penalty(self, fit: GalaxyFit) -> float:
        """Minus twice the log density of a source of the sky model, up to a constant."""
        total = (abs(fit.ellipticity) / self.ellipticity_sigma) ** 2
        total += ((fit.flux - self.flux) / self.flux_sigma) ** 2
        total += float(np.sum((fit.offset / self.position_sigma) ** 2))
        if fit.scale_length > 0:
            total += self._size_deviation(fit) ** 2
        return total

    def pull(self, fit: GalaxyFit) -> tuple[Float[Array, " 6"], Float[Array, " 6"]]:
        """Gradient of the log density with respect to flux, e1, e2, ln alpha, l, m, and the precision of each.

        A point source has no shape; in its three rows the precision is one, so that the equations are not singular.
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
