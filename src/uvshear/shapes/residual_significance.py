"""Test of whether the residual around a source is noise."""

import math

import numpy as np

from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.lattices import hexagonal_lattice

SIGNIFICANT = 5.5
"""Significance, in standard deviations, above which a residual is not noise: its probability is 4e-8 for both signs
together, and about a hundred positions are examined for each source."""

REACH = 6.0
"""Distance from the source within which residuals are examined, in scale lengths."""

SPACING = 1.2
"""Distance between the positions that are examined, in scale lengths: a residual halfway between them loses a tenth."""


def residual_significance(residual: Facet, profile: Profile, scale_length: float) -> float:
    """Return the largest residual around a source, of either sign, in standard deviations of the noise.

    With a round galaxy m at each position x, the significance is <r, m_x> / sqrt<m, m>.

    Parameters
    ----------
    residual
        Facet from which all sources are subtracted, including this one.
    profile
        Brightness profile of the round galaxy.
    scale_length
        Scale length of the round galaxy [rad].
    """
    correlator = Correlator(residual, profile)
    size = scale_length / correlator.length
    nodes = hexagonal_lattice(REACH * size, SPACING * size)
    displaced = correlator.displaced_to(nodes)
    heights, norm = correlator.correlate(
        np.zeros(1, complex), np.array([math.log(scale_length)]), displaced
    )
    if norm[0] <= 0:
        return 0.0
    return float(np.max(np.abs(heights[0]))) / math.sqrt(float(norm[0]))
