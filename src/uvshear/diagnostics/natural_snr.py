"""Signal-to-noise ratios of natural weights, whatever baselines a shape was taken from."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from uvshear.diagnostics.natural_norms import natural_norms
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.response import Response
from uvshear.shapes.measurement import ShapeMeasurement


def with_natural_snr(
    measurements: Mapping[int, ShapeMeasurement],
    observation: Observation,
    sky: Galaxies,
    profile: Profile,
    executor: Executor = SERIAL,
    response: Response | None = None,
) -> Mapping[int, ShapeMeasurement]:
    """Quote S sqrt(<m, m>) over all visibilities, which are read once, for the galaxies of the ``sky``.

    Of what a ``response`` leaves of them, if there is one.
    """
    if not measurements:
        return measurements
    order = np.array(list(measurements))
    galaxies = sky.select(order)
    norms = natural_norms(observation, galaxies, profile, executor)
    if response is not None:
        norms = norms * response.attenuations(galaxies) ** 2
    return {
        source: replace(shape, snr=shape.flux * float(np.sqrt(norm)))
        for (source, shape), norm in zip(measurements.items(), norms, strict=True)
    }
