"""Removal of a simulated bias from a shear."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from uvshear.estimators.shear_estimate import ShearEstimate


@dataclass(frozen=True)
class Component:
    """Bias of one component of the shear: g measured = (1 + m) g + c.

    Parameters
    ----------
    m, m_err
        Multiplicative bias and its standard error.
    c, c_err
        Additive bias and its standard error.
    """

    m: float
    m_err: float
    c: float
    c_err: float

    def corrected(self, measured: float, error: float) -> tuple[float, float]:
        """Return the shear without the bias, and its standard error from those of the shear, c and m in quadrature."""
        g = (measured - self.c) / (1 + self.m)
        return g, math.sqrt(error**2 + self.c_err**2 + (g * self.m_err) ** 2) / (1 + self.m)


Pair = tuple[Component, Component]
"""Biases of both components of the shear."""


@dataclass(frozen=True)
class BiasCorrection:
    """A simulated bias of an estimator, with the options under which it was simulated.

    Parameters
    ----------
    total
        Bias of all galaxies.
    bins
        Bias of the galaxies of each bin of flux, by the name of the bin.
    estimator
        Name of the estimator.
    snr_min, flux_min
        Signal-to-noise ratio and flux [Jy] below which galaxies were left out.
    prior
        Origin of the population of a Bayesian estimate: ``paper``, ``fitted`` or ``file``.
    averages_cells
        Whether the facets were the paper's, which average in cells.
    cuts_on_measured
        Whether ``snr_min`` was a cut on the fitted signal-to-noise ratio, as for a shear, and not on the catalogue's.
    """

    total: Pair
    bins: Mapping[str, Pair]
    estimator: str
    snr_min: float
    flux_min: float = 0.0
    prior: str = "paper"
    averages_cells: bool = False
    cuts_on_measured: bool = True

    def applied(self, estimate: ShearEstimate) -> ShearEstimate:
        """Return the shear of all galaxies without the bias."""
        return _without(self.total, estimate)

    def applied_by_flux(self, estimates: Mapping[str, ShearEstimate]) -> dict[str, ShearEstimate]:
        """Return the shear of each bin without the bias of that bin; bins that were not simulated are left out."""
        return {
            name: _without(self.bins[name], estimate)
            for name, estimate in estimates.items()
            if name in self.bins
        }


def _without(bias: Pair, estimate: ShearEstimate) -> ShearEstimate:
    g1, g1_err = bias[0].corrected(estimate.g1, estimate.g1_err)
    g2, g2_err = bias[1].corrected(estimate.g2, estimate.g2_err)
    return replace(estimate, g1=g1, g1_err=g1_err, g2=g2, g2_err=g2_err)
