"""Shapes from weights other than the natural ones, with errors that are right."""

import math
from dataclasses import replace

import numpy as np

from uvshear.diagnostics.weighting_loss import weighting_loss
from uvshear.errors import InputError
from uvshear.extraction.field import Field
from uvshear.extraction.options import MeasurementOptions
from uvshear.galaxy import Profile
from uvshear.interferometer.baseline_map import BaselineMap
from uvshear.interferometer.visibilities import Observation
from uvshear.interferometer.weighting import TukeyTaper, WeightedObservation, weighted
from uvshear.typing import Array, Float

SIZES = 9
"""Number of scale lengths at which the loss is computed, evenly spaced in the logarithm over those of a field."""


def weigh(
    observation: Observation, field: Field, options: MeasurementOptions
) -> tuple[WeightedObservation, Float[Array, " source"]]:
    """Apply the weightings of the options within the uv range, and return the weight correction of each source.

    Fits assume that weights are 1/sigma^2. The weights are therefore scaled such that the errors of e are right for a
    galaxy of the median size; the remaining factor for other sizes is the ``weight_correction`` of each source. The
    errors of fluxes are not corrected: with SKA-Mid AA2 and discs of 1 arcsec they are a third too large (Briggs or
    uniform weights), or a tenth to a fifth too small (Gaussian tapers of 1.5 and 4 arcsec).
    """
    cut = TukeyTaper(options.method.uv_range.minimum, options.method.uv_range.maximum)
    seen = weighted(observation, (cut, *options.method.weightings))
    cells = seen.map_baselines()
    log_size = field.size.log_median
    measured = log_size[field.measured]
    middle = float(np.median(measured))
    typical = _log_scale(cells, middle, options.model.profile)
    nodes = np.linspace(measured.min(), measured.max(), SIZES)
    scales = np.array(
        [_log_scale_or(cells, node, options.model.profile, typical) for node in nodes]
    )
    correction = np.exp(np.interp(log_size, nodes, scales) - typical)
    return replace(seen, scale=math.exp(typical)), correction


def _log_scale(cells: BaselineMap, log_size: float, profile: Profile) -> float:
    return -math.log(weighting_loss(cells, math.exp(log_size), profile).variance_over_beam)


def _log_scale_or(cells: BaselineMap, log_size: float, profile: Profile, other: float) -> float:
    """Return the log scale of a size, or ``other`` where the baselines do not determine its shape: fits will say so."""
    try:
        return _log_scale(cells, log_size, profile)
    except InputError:
        return other
