"""Signal-to-noise ratios of natural weights, whatever baselines a shape was taken from."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from uvshear.extraction.natural import natural_norms
from uvshear.fit.measurement import ShapeMeasurement
from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.visibilities import Observation


def with_natural_snr(
    measurements: Mapping[int, ShapeMeasurement],
    observation: Observation,
    sky: Galaxies,
    profile: Profile,
    threads: int = 1,
) -> Mapping[int, ShapeMeasurement]:
    """Quote S sqrt(<m, m>) over all visibilities, which are read once, for the galaxies of the ``sky``."""
    if not measurements:
        return measurements
    order = np.array(list(measurements))
    norms = natural_norms(observation, sky.select(order), profile, threads)
    return {
        source: replace(shape, snr=shape.flux * float(np.sqrt(norm)))
        for (source, shape), norm in zip(measurements.items(), norms, strict=True)
    }
