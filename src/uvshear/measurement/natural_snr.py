"""Signal-to-noise ratios of natural weights, whatever baselines a shape was taken from."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from uvshear.extraction.natural import natural_norms
from uvshear.fit.measurement import ShapeMeasurement
from uvshear.galaxy import Galaxies
from uvshear.interferometer.visibilities import Observation

if TYPE_CHECKING:  # the options hold an extraction
    from uvshear.measurement.options import MeasurementOptions


def with_natural_snr(
    measurements: Mapping[int, ShapeMeasurement],
    observation: Observation,
    sky: Galaxies,
    options: "MeasurementOptions",
) -> Mapping[int, ShapeMeasurement]:
    """Quote S sqrt(<m, m>) over all visibilities for the galaxies of the ``sky``; they are read for a uv range only."""
    if options.uv_range.is_everything or not measurements:
        return measurements
    order = np.array(list(measurements))
    norms = natural_norms(observation, sky.select(order), options.profile, options.threads)
    return {
        source: replace(shape, snr=shape.flux * float(np.sqrt(norm)))
        for (source, shape), norm in zip(measurements.items(), norms, strict=True)
    }
