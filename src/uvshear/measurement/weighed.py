"""Shapes from weights other than the natural ones, with errors that are right."""

from dataclasses import replace

import numpy as np

from uvshear.extraction.weighting_loss import weighting_loss
from uvshear.interferometer.baseline_map import BaselineMap
from uvshear.interferometer.visibilities import Observation
from uvshear.interferometer.weighting import WeightedObservation, weighted
from uvshear.measurement.field import Field
from uvshear.measurement.options import MeasurementOptions


def weigh(
    observation: Observation, field: Field, options: MeasurementOptions
) -> WeightedObservation:
    """Apply the weightings that are asked for.

    Fits take weights for 1/sigma^2. So they are scaled by what makes this true of the ellipticity of a galaxy of the
    median size: of galaxies twice as large or half as large the errors are then good to some per cent.
    """
    seen = weighted(observation, options.weightings)
    size = float(np.exp(np.median(field.size.log_median[field.modelled])))
    loss = weighting_loss(BaselineMap.of(seen.with_factors()), size, options.profile)
    return replace(seen, scale=1 / loss.variance_over_beam)
