"""Positions and shapes besides the best fit that the data of a faint galaxy allow."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.shapes.correlator import Correlator
from uvshear.shapes.lattices import hexagonal_lattice, shape_lattice
from uvshear.shapes.maximum import BestFit, search_radius
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Complex, Float

DEPTH = 8.0
"""Difference in log density from the highest, 4 sigma, beyond which a position or shape counts as unlikely."""


@dataclass(frozen=True)
class PosteriorModes:
    """Positions and shapes whose density is within ``DEPTH`` of the highest.

    They are in the units of a correlator that is centred on the best fit. Each position is likely for some shape, and
    each shape for some position.

    Parameters
    ----------
    positions
        Likely points of a lattice, and the position of the best fit.
    spacing
        Distance between the points of that lattice.
    sigma
        Standard deviation of the position about the peak of one shape.
    ellipticity, log_scale_length
        Likely shapes; the size is ln(scale length / rad).
    """

    positions: Float[Array, "node 2"]
    spacing: float
    sigma: float
    ellipticity: Complex[Array, " sample"]
    log_scale_length: Float[Array, " sample"]

    @classmethod
    def from_lattices(cls, correlator: Correlator, prior: ShapePrior, best: BestFit) -> Self:
        """Evaluate a coarse lattice of shapes, and the best fit, over the whole prior on the position."""
        width = correlator.peak_width(prior.log_scale_length)
        sigma = width / best.snr
        # Two standard deviations of the position, but not coarser than the peak of the cross-correlation allows.
        spacing = min(2.0 * sigma, 0.15 * width)
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
