"""The noise at which a galaxy of a given flux has a given signal-to-noise ratio."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.constants import MICROJANSKY, SPECTRAL_INDEX
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile, SizeFluxRelation
from uvshear.interferometer.coverage import Coverage
from uvshear.interferometer.noise import ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.predict import predict_visibilities

ROWS = 1_000_000
"""Number of rows that are predicted at a time."""


@dataclass(frozen=True)
class GalaxyNoise:
    """Noise at which a galaxy has a given signal-to-noise ratio.

    Parameters
    ----------
    flux
        Flux of a round galaxy at the phase centre, of the median size for its flux [Jy].
    snr
        Its signal-to-noise ratio with natural weights: the flux over its error at fixed shape.
    """

    flux: float = 10 * MICROJANSKY
    snr: float = 10.0

    def scaled_to(
        self, coverage: Coverage, channels: Channels, profile: Profile, executor: Executor = SERIAL
    ) -> ScaledNoise:
        r"""Return the noise that gives this ratio on these baselines.

        .. math:: \sigma = \frac{1}{\mathrm{SNR}} \Big[\sum_k |V_k|^2\Big]^{1/2}
        """
        flux = np.array([self.flux])
        galaxy = Galaxies(
            l=np.zeros(1),
            m=np.zeros(1),
            flux=flux,
            scale_length=SizeFluxRelation().median(flux),
            ellipticity=np.zeros(1, complex),
            spectral_index=np.array([SPECTRAL_INDEX]),
        )
        power = 0.0
        for start in range(0, len(coverage), ROWS):
            uvw = coverage.uvw[start : start + ROWS]
            vis = predict_visibilities(galaxy, uvw, channels.frequency, profile, executor)
            power += float(np.sum(np.abs(vis) ** 2))
        return ScaledNoise(math.sqrt(power) / self.snr)
