"""What a fit needs of the visibilities around one direction."""

from dataclasses import dataclass

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


@dataclass(frozen=True)
class BeamPlane:
    """Cells of half of the uv plane with the power of a beam, fine enough for sources some way apart.

    Parameters
    ----------
    uv
        Cell centres [wavelengths].
    power
        Weighted sum of the squared response to a unit point source [Jy^-2].
    """

    uv: Float[Array, "cell 2"]
    power: Float[Array, " cell"]
