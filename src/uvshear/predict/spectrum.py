"""Power laws about a common one: what a sky image can carry of many spectral indices."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.galaxy import Galaxies
from uvshear.typing import Array, Float

TOLERANCE = 1e-4
"""Relative error of a flux density at which the expansion ends."""

_MOST_TERMS = 8


@dataclass(frozen=True)
class SpectralExpansion:
    r"""Flux densities as a common power law times a polynomial in the logarithm of the frequency.

    .. math:: S_s (\nu/\nu_\mathrm{ref})^{\beta_s} = (\nu/\nu_\mathrm{ref})^{\beta_0}
              \sum_j S_{sj}\, \ln^j(\nu/\nu_0),\quad
              S_{sj} = S_s (\nu_0/\nu_\mathrm{ref})^{\beta_s-\beta_0} (\beta_s - \beta_0)^j / j!

    Parameters
    ----------
    fluxes
        S_sj [Jy].
    index
        beta_0.
    frequency
        nu_0 [Hz].
    reference_frequency
        nu_ref [Hz].
    """

    fluxes: Float[Array, "term source"]
    index: float
    frequency: float
    reference_frequency: float

    @classmethod
    def of(cls, galaxies: Galaxies, lowest: float, highest: float) -> Self:
        """Expand, with as many terms as the band of frequencies [Hz] needs."""
        index = float(np.median(galaxies.spectral_index)) if len(galaxies) else 0.0
        frequency = math.sqrt(lowest * highest)
        away = galaxies.spectral_index - index
        first = galaxies.flux * (frequency / galaxies.reference_frequency) ** away
        reach = float(np.max(np.abs(away), initial=0.0)) * math.log(highest / frequency)
        terms, left = 1, reach
        while left > TOLERANCE and terms < _MOST_TERMS:
            terms += 1
            left *= reach / terms
        fluxes = np.array([first * away**j / math.factorial(j) for j in range(terms)])
        return cls(fluxes, index, frequency, galaxies.reference_frequency)

    def gain(self, frequency: Float[Array, " sample"]) -> Float[Array, " sample"]:
        """Evaluate the common power law at each frequency [Hz]."""
        return ((frequency / self.reference_frequency) ** self.index).astype(np.float32)

    def logarithm(self, frequency: Float[Array, " sample"]) -> Float[Array, " sample"]:
        """ln(nu/nu_0)."""
        return np.log(frequency / self.frequency).astype(np.float32)
