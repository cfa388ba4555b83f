"""The galaxies of a field: their positions, fluxes, sizes and ellipticities."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.constants import REFERENCE_FREQUENCY
from uvshear.errors import InputError
from uvshear.typing import Array, Complex, Float


@dataclass(frozen=True)
class Galaxies:
    """Parameters of galaxies, one element for each; docs/conventions.md has the conventions.

    Parameters
    ----------
    l, m
        Direction cosines relative to the phase centre, to the East and to the North.
    flux
        Flux density at ``reference_frequency`` [Jy].
    scale_length
        Scale length alpha of the profile [rad]; 0 is a point source.
    ellipticity
        e = e1 + i e2, |e| = (a-b)/(a+b) < 1, in the (l, m) frame.
    spectral_index
        Exponent beta of the flux density, S proportional to frequency^beta.
    reference_frequency
        Frequency to which the flux densities refer [Hz].
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    flux: Float[Array, " source"]
    scale_length: Float[Array, " source"]
    ellipticity: Complex[Array, " source"]
    spectral_index: Float[Array, " source"]
    reference_frequency: float = REFERENCE_FREQUENCY

    def __post_init__(self) -> None:
        if np.any(np.abs(self.ellipticity) >= 1):
            raise InputError("an ellipticity has |e| >= 1; |e| = (a-b)/(a+b) is always below 1")
        if np.any(self.scale_length < 0):
            raise InputError(
                "a scale length is negative; it must be positive, or zero for a point source"
            )

    def __len__(self) -> int:
        return len(self.l)

    def select(self, index: Array | slice) -> Self:
        """Return the galaxies at ``index`` (any one-dimensional numpy index)."""
        return replace(
            self,
            l=self.l[index],
            m=self.m[index],
            flux=self.flux[index],
            scale_length=self.scale_length[index],
            ellipticity=self.ellipticity[index],
            spectral_index=self.spectral_index[index],
        )
