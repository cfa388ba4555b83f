"""What natural weights would make of a source, whatever baselines its shape is taken from."""

import math

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.baseline_map import map_baselines
from uvshear.interferometer.visibilities import Observation
from uvshear.typing import Array, Float


def natural_norms(
    observation: Observation, galaxies: Galaxies, profile: Profile, executor: Executor = SERIAL
) -> Float[Array, " source"]:
    """<m, m> of each galaxy for unit flux over every visibility [Jy^-2]: snr = S sqrt<m, m>.

    From a map of the weights over the length (in logarithmic steps) and the angle of the baselines: a model's
    square has no phase, so that it hardly changes across a cell. The tilt of baselines seen from off the phase centre
    is left out.
    """
    cells = map_baselines(observation)
    form = np.stack(quadratic_form(galaxies.ellipticity, galaxies.scale_length), axis=-1)
    squares = 4 * math.pi**2 * np.stack([cells.u**2, cells.u * cells.v, cells.v**2])
    squares, weight = squares.astype(np.float32), cells.weight.astype(np.float32)

    def norm(source: int) -> float:
        q = form[source].astype(np.float32) @ squares
        index, reference = galaxies.spectral_index[source], galaxies.reference_frequency
        gain = np.exp(2 * index * (cells.log_frequency - math.log(reference))).astype(np.float32)
        return float(np.sum(weight * gain * profile.envelope(q) ** 2, dtype=float))

    return np.array(list(executor.map(norm, range(len(galaxies)))))
