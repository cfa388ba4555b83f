"""What is known of a galaxy before its fit."""

from dataclasses import dataclass, field

from uvshear.galaxy import EllipticityPrior, FlatEllipticityPrior


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
        Density over the plane of e; flat over |e| < 0.95 unless given.
    """

    log_scale_length: float
    log_scale_length_sigma: float
    position_radius: float | None = None
    ellipticity: EllipticityPrior = field(default_factory=FlatEllipticityPrior)
