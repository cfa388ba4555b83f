"""Positions and shapes away from the best fit that the data allow too: those of a faint galaxy are many."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.shapes.correlator import Correlator
from uvshear.shapes.lattices import hexagonal_lattice, shape_lattice
from uvshear.shapes.maximum import BestFit, peak_width, search_radius
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Complex, Float

DEPTH = 8.0
"""Drop of log density below the highest at which nothing is likely any more: 4 sigma."""

_SPACING = 2.0
"""Of the lattice of positions that are tried, over the standard deviation about one shape's peak."""

_WIDEST = 0.15
"""Most of that spacing, over the width of the cross-correlation's peak."""


@dataclass(frozen=True)
class Likely:
    """What is within ``DEPTH`` of the highest, in the units of a correlator centred on the best fit.

    Each position is likely for some shape, each shape for some position.

    Parameters
    ----------
    positions
        Points of a lattice, and the best fit's.
    spacing
        Of the lattice.
    sigma
        Standard deviation of the position about one shape's peak.
    ellipticity, log_scale_length
        The shapes.
    """

    positions: Float[Array, "node 2"]
    spacing: float
    sigma: float
    ellipticity: Complex[Array, " sample"]
    log_scale_length: Float[Array, " sample"]

    @classmethod
    def of(cls, correlator: Correlator, prior: ShapePrior, best: BestFit) -> Self:
        """Try a coarse lattice of shapes, and the best fit's, all over the prior of the position."""
        width = peak_width(correlator, prior)
        sigma = width / best.snr
        spacing = min(_SPACING * sigma, _WIDEST * width)
        lattice = hexagonal_lattice(search_radius(correlator, prior), spacing)
        positions = np.vstack([lattice - best.position, np.zeros((1, 2))])
        e, deviation = shape_lattice()
        e = np.append(e, best.ellipticity)
        size = prior.log_scale_length + deviation * prior.log_scale_length_sigma
        size = np.append(size, best.log_scale_length)
        heights, norm = correlator.correlate(e, size, correlator.displaced_to(positions))
        reached = np.where(norm > 0, norm, np.inf)
        away = (size - prior.log_scale_length) / prior.log_scale_length_sigma
        log_density = (
            np.maximum(heights, 0) ** 2 / (2 * reached)[:, None] - 0.5 * away[:, None] ** 2
        )
        is_likely = log_density > log_density.max() - DEPTH
        shapes = is_likely.any(axis=1)
        return cls(positions[is_likely.any(axis=0)], spacing, sigma, e[shapes], size[shapes])
