"""The noise at which a galaxy of a given flux has a given signal-to-noise ratio."""

import math

import numpy as np

from uvshear.constants import SPECTRAL_INDEX
from uvshear.galaxy import Galaxies, Profile, SizeFluxRelation
from uvshear.interferometer.coverage import Coverage
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.predict import predict_visibilities

ROWS = 1_000_000
"""Rows predicted at a time."""


def noise_for_galaxy(
    coverage: Coverage,
    channels: Channels,
    profile: Profile,
    *,
    flux: float,
    snr: float,
    threads: int = 1,
) -> ScaledNoise:
    r"""Scale the noise so that S sqrt<m, m> = ``snr`` with natural weights.

    .. math:: \sigma = \frac{1}{\mathrm{SNR}} \Big[\sum_k |V_k|^2\Big]^{1/2}

    for a round galaxy of ``flux`` [Jy] and of the median size of its flux at the phase centre.
    """
    fluxes = np.array([flux])
    galaxy = Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=fluxes,
        scale_length=SizeFluxRelation().median(fluxes),
        ellipticity=np.zeros(1, complex),
        spectral_index=np.array([SPECTRAL_INDEX]),
    )
    power = 0.0
    for start in range(0, len(coverage), ROWS):
        uvw = coverage.uvw[start : start + ROWS]
        vis = predict_visibilities(galaxy, uvw, channels.frequency, profile, threads)
        power += float(np.sum(np.abs(vis) ** 2))
    return ScaledNoise(math.sqrt(power) / snr)
