"""Facets: the visibilities around one direction, reduced to sufficient statistics."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.typing import Array, Complex, Float


@dataclass(frozen=True)
class Facet:
    """Sufficient statistics of one source: cells of the uv plane, folded to half of it (Hermitian symmetry).

    With V the real envelope of a model of unit flux, displaced by x from the facet's centre,
    <d, m> = sum Re[correlation conj(V exp(2 pi i uv.x))] and <m, m> = sum power V^2.

    Parameters
    ----------
    uv
        Cell centres [wavelengths].
    correlation
        Weighted sum of the visibilities phased to the facet's centre [Jy^-1].
    power
        Weighted sum of the squared response to a unit point source [Jy^-2].
    """

    uv: Float[Array, "cell 2"]
    correlation: Complex[Array, " cell"]
    power: Float[Array, " cell"]

    def within(self, longest: float) -> Self:
        """Return the cells whose distance from the origin is at most ``longest`` [wavelengths]."""
        near = np.hypot(*self.uv.T) <= longest
        return type(self)(self.uv[near], self.correlation[near], self.power[near])

    def in_other_unit(self, unit: float) -> Self:
        """Return the same facet with fluxes in units that are ``unit`` times the present ones."""
        return type(self)(self.uv, self.correlation * unit, self.power * unit**2)

    @property
    def has_power(self) -> bool:
        """Whether any cell has power."""
        return bool(np.any(self.power > 0))


@dataclass(frozen=True)
class BeamPlane:
    """Cells of half of the uv plane with the power of a beam, fine enough for sources at some distance from each other.

    Parameters
    ----------
    uv
        Cell centres [wavelengths].
    power
        Weighted sum of the squared response to a unit point source [Jy^-2].
    """

    uv: Float[Array, "cell 2"]
    power: Float[Array, " cell"]
