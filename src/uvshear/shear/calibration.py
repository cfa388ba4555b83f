"""A simulated bias, taken out of a shear."""

import math
from dataclasses import dataclass, replace

from uvshear.shear.mean import ShearEstimate


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


@dataclass(frozen=True)
class Calibration:
    """Bias of an ``estimator`` for galaxies of some signal-to-noise ratio and more."""

    first: Component
    second: Component
    estimator: str
    snr_min: float

    def applied(self, estimate: ShearEstimate) -> ShearEstimate:
        """Take the bias out of a shear of that estimator."""
        g1, g1_err = self.first.corrected(estimate.g1, estimate.g1_err)
        g2, g2_err = self.second.corrected(estimate.g2, estimate.g2_err)
        return replace(estimate, g1=g1, g1_err=g1_err, g2=g2, g2_err=g2_err)
