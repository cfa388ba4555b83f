"""Visibilities of galaxies at samples that each have a frequency of their own, by the exact sum over sources."""

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.samples import Samples
from uvshear.predict.direct import sum_of_sources
from uvshear.typing import Array, Complex, Float

SLAB = 4096
"""Number of samples in a slab."""


def predict_at_samples(
    galaxies: Galaxies,
    samples: Samples,
    profile: Profile,
    attenuation: Attenuation | None = None,
    executor: Executor = SERIAL,
) -> Complex[Array, " sample"]:
    """Sum the visibilities of all galaxies [Jy], as ``predict_visibilities`` does for rows and channels.

    Parameters
    ----------
    samples
        Samples of the uv plane; their data and weights are not used.
    attenuation
        Attenuation by averaging and primary beams; none unless given.
    """

    def predict(start: int) -> Complex[Array, " slab"]:
        part = samples.select(slice(start, start + SLAB))
        ratio = part.frequency / galaxies.reference_frequency
        powers = {index: ratio**index for index in set(galaxies.spectral_index.tolist())}
        attenuated = None if attenuation is None else attenuation.over(part)

        def multiply(sources: slice, factors: Float[Array, "source slab"]) -> None:
            indices = galaxies.spectral_index[sources].tolist()
            for factor, index in zip(factors, indices, strict=True):
                factor[:] *= powers[index]
            if attenuated is not None:
                attenuated.multiply(factors, galaxies.l[sources], galaxies.m[sources])

        return sum_of_sources(galaxies, part.uvw, profile, multiply)

    parts = list(executor.map(predict, range(0, len(samples), SLAB)))
    return np.concatenate(parts) if parts else np.zeros(0, complex)
