"""A simulated bias, taken out of a shear."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from uvshear.estimators.shear_estimate import ShearEstimate


@dataclass(frozen=True)
class Component:
    """g measured = (1 + m) g + c of one component, with standard errors."""

    m: float
    m_err: float
    c: float
    c_err: float

    def corrected(self, measured: float, error: float) -> tuple[float, float]:
        """Shear behind a measured one, and its error: the measurement's, c's and m's in quadrature."""
        g = (measured - self.c) / (1 + self.m)
        return g, math.sqrt(error**2 + self.c_err**2 + (g * self.m_err) ** 2) / (1 + self.m)


Pair = tuple[Component, Component]
"""Of both components."""


@dataclass(frozen=True)
class BiasCorrection:
    """Bias of an estimator, in total and by flux.

    Parameters
    ----------
    total
        Of all galaxies.
    bins
        By the name of the bin.
    estimator
        Its name.
    snr_min, flux_min
        Cuts that the galaxies had passed, by signal-to-noise ratio and by flux [Jy].
    prior
        Where a Bayesian estimate's population had come from: ``paper``, ``fitted`` or ``file``.
    averages_cells
        Whether it is of the paper's facets.
    cuts_on_measured
        Whether the signal-to-noise ratio of the cut was that of the fit, as a shear's is.
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
        """Take the bias out of the shear of all galaxies."""
        return _without(self.total, estimate)

    def applied_by_flux(self, estimates: Mapping[str, ShearEstimate]) -> dict[str, ShearEstimate]:
        """Take its own bias out of the shear of each bin; bins that were not simulated are left out."""
        return {
            name: _without(self.bins[name], one)
            for name, one in estimates.items()
            if name in self.bins
        }


def _without(bias: Pair, estimate: ShearEstimate) -> ShearEstimate:
    g1, g1_err = bias[0].corrected(estimate.g1, estimate.g1_err)
    g2, g2_err = bias[1].corrected(estimate.g2, estimate.g2_err)
    return replace(estimate, g1=g1, g1_err=g1_err, g2=g2, g2_err=g2_err)
