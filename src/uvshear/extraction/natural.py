"""What natural weights would make of a source, whatever baselines its shape is taken from."""

from dataclasses import replace

import numpy as np

from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.visibilities import Observation
from uvshear.predict import predict_visibilities
from uvshear.typing import Array, Float


def natural_norms(
    observation: Observation, galaxies: Galaxies, profile: Profile, threads: int = 1
) -> Float[Array, " source"]:
    """<m, m> of each galaxy for unit flux over every visibility [Jy^-2]: snr = S sqrt<m, m>."""
    norms = np.zeros(len(galaxies))
    for chunk in observation.chunks():
        for source in range(len(galaxies)):
            one = replace(galaxies.select(np.array([source])), flux=np.ones(1))
            model = predict_visibilities(one, chunk.uvw, chunk.frequency, profile, threads)
            norms[source] += float(np.sum(chunk.weights * np.abs(model) ** 2, dtype=float))
    return norms
