"""Signal-to-noise ratios of natural weights, whatever baselines a shape was taken from."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from uvshear.extraction.natural import natural_norms
from uvshear.fit.measurement import ShapeMeasurement
from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.response import Response


def with_natural_snr(
    measurements: Mapping[int, ShapeMeasurement],
    observation: Observation,
    sky: Galaxies,
    profile: Profile,
    threads: int = 1,
    response: Response | None = None,
) -> Mapping[int, ShapeMeasurement]:
    """Quote S sqrt(<m, m>) over all visibilities, which are read once, for the galaxies of the ``sky``.

    Of what a ``response`` leaves of them, if there is one.
    """
    if not measurements:
        return measurements
    order = np.array(list(measurements))
    galaxies = sky.select(order)
    norms = natural_norms(observation, galaxies, profile, threads)
    if response is not None:
        norms = norms * response.attenuations(galaxies) ** 2
    return {
        source: replace(shape, snr=shape.flux * float(np.sqrt(norm)))
        for (source, shape), norm in zip(measurements.items(), norms, strict=True)
    }
