"""Signal-to-noise ratios with natural weights, whatever the baselines on which a shape was measured."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.baseline_map import BaselineMap
from uvshear.predict.response import Response
from uvshear.shapes.measurement import ShapeMeasurement
from uvshear.typing import Array, Float

_BATCH = 32
"""Number of galaxies whose norms are one task."""


def with_natural_snr(
    measurements: Mapping[int, ShapeMeasurement],
    cells: BaselineMap,
    sky: Galaxies,
    profile: Profile,
    response: Response | None = None,
    executor: Executor = SERIAL,
) -> Mapping[int, ShapeMeasurement]:
    """Return the measurements with the signal-to-noise ratio S sqrt(<m, m>) over all visibilities.

    Parameters
    ----------
    measurements
        Shapes by index of the catalogue.
    cells
        Natural weights of all visibilities.
    sky
        All sources of the catalogue with their fitted parameters.
    profile
        Brightness profile of the galaxies.
    response
        Attenuation of the sources; none unless given.
    executor
        Executor for the galaxies.
    """
    if not measurements:
        return measurements
    galaxies = sky.select(np.array(list(measurements)))
    norms = natural_norms(cells, galaxies, profile, executor)
    if response is not None:
        norms = norms * response.attenuations(galaxies) ** 2
    return {
        source: replace(shape, snr=shape.flux * float(np.sqrt(norm)))
        for (source, shape), norm in zip(measurements.items(), norms, strict=True)
    }


def natural_norms(
    cells: BaselineMap, galaxies: Galaxies, profile: Profile, executor: Executor = SERIAL
) -> Float[Array, " source"]:
    """<m, m> of each galaxy for unit flux over every visibility [Jy^-2]: snr = S sqrt<m, m>.

    The weights are mapped by the length (in logarithmic steps) and the angle of the baselines. The square of a model
    has no phase, so that it hardly changes across a cell of this map. The shift of baselines for sources away from the
    phase centre is neglected.
    """
    form = np.stack(quadratic_form(galaxies.ellipticity, galaxies.scale_length), axis=-1)
    squares = 4 * math.pi**2 * np.stack([cells.u**2, cells.u * cells.v, cells.v**2])
    squares, weight = squares.astype(np.float32), cells.weight.astype(np.float32)

    def norm(source: int) -> float:
        q = form[source].astype(np.float32) @ squares
        index, reference = galaxies.spectral_index[source], galaxies.reference_frequency
        gain = np.exp(2 * index * (cells.log_frequency - math.log(reference))).astype(np.float32)
        return float(np.sum(weight * gain * profile.envelope(q) ** 2, dtype=float))

    return np.array(list(executor.map_in_batches(norm, range(len(galaxies)), _BATCH)))
