"""Facets cut out of images: a square of pixels, its Fourier transform, and the half of the uv plane that is kept."""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy import fft

from uvshear.numerics.fft_sizes import fast_size
from uvshear.numerics.half_plane import HalfPlane, half_plane
from uvshear.typing import Array, Complex, Float, Int


@dataclass(frozen=True)
class Cutout:
    """A square of pixels and the cells of its uv plane that are kept.

    Parameters
    ----------
    size
        Number of pixels along a side, a multiple of four.
    pixel
        Width of a pixel [rad].
    shortest, longest
        Limits of the distance of the cells from the origin [wavelengths].
    """

    size: int
    pixel: float
    shortest: float
    longest: float

    @cached_property
    def _half_plane(self) -> HalfPlane:
        return half_plane(self.size, self.pixel, self.shortest, self.longest)

    @property
    def cells(self) -> tuple[Int[Array, " cell"], Int[Array, " cell"]]:
        """Positions of the cells in what ``rfft2`` returns."""
        return self._half_plane.index

    @property
    def uv(self) -> Float[Array, "cell 2"]:
        """Centres of the cells [wavelengths]."""
        return self._half_plane.uv

    @property
    def multiplicity(self) -> Float[Array, " cell"]:
        """Number of cells of the whole plane that each cell stands for."""
        return self._half_plane.multiplicity

    @cached_property
    def origin(self) -> int:
        """Index of the cell at u = v = 0, which exists only where ``shortest`` is 0."""
        return int(np.argmin(np.hypot(*self.uv.T)))

    @cached_property
    def _scale(self) -> Float[Array, " cell"]:
        # With the origin at the centre of the square, the sign alternates from cell to cell.
        i, j = self.cells
        return (self.multiplicity * (-1.0) ** (i + j) / self.size**2).astype(np.float32)

    def transform(self, square: Float[Array, "l m"]) -> Complex[Array, " cell"]:
        """Facet of a square of a dirty image.

        The transform is conjugated, because a source at x is exp(+2 pi i k.x) in a facet.
        """
        paired = square.copy()
        paired[0, :] = paired[:, 0] = 0
        spectrum = fft.rfft2(paired, overwrite_x=True)
        return spectrum[self.cells].conj() * self._scale

    @cached_property
    def coarse_cells(self) -> tuple[Int[Array, " low"], Array, Array]:
        """Cells that pixels twice as wide resolve, and their positions in the transform of a square of such pixels."""
        half = self.size // 2
        i, j = self.cells
        signed = np.where(i > self.size // 2, i - self.size, i)
        low = np.flatnonzero((np.abs(signed) < half // 2) & (j < half // 2))
        return low, signed[low] % half, j[low]

    def add_coarse(
        self, square: Float[Array, "l m"], factor: float, facet: Complex[Array, " cell"]
    ) -> None:
        """Add to a facet the transform of the same square on pixels twice as wide.

        Parameters
        ----------
        square
            Values of the coarse pixels.
        factor
            Factor by which the transform is multiplied.
        facet
            Facet that is added to, on the cells that the coarse pixels resolve.
        """
        low, i, j = self.coarse_cells
        paired = square.copy()
        paired[0, :] = paired[:, 0] = 0
        spectrum = fft.rfft2(paired, overwrite_x=True)[i, j].conj()
        sign = (-1.0) ** (i + j)
        facet[low] += (factor * 4 / self.size**2) * (self.multiplicity[low] * sign) * spectrum

    def recentring(self, offset: tuple[float, float]) -> Complex[Array, " cell"]:
        """Phases that move a facet's centre by ``offset`` [rad]."""
        i, j = self.cells
        u, v = fft.fftfreq(self.size, self.pixel), fft.rfftfreq(self.size, self.pixel)
        along_u, along_v = (
            np.exp(-2j * math.pi * x * k).astype(np.complex64)
            for x, k in zip(offset, (u, v), strict=True)
        )
        return along_u[i] * along_v[j]


@lru_cache(maxsize=1024)
def cutout(size: int, pixel: float, shortest: float, longest: float) -> Cutout:
    """Return one cutout for the same numbers, so that sources share their cells."""
    return Cutout(size, pixel, shortest, longest)


def cutout_size(width: float, pixel: float) -> int:
    """Find a number of pixels for a width [rad] that is quick to transform, on pixels twice as wide too."""
    return fast_size(max(width / pixel, 32), multiple=4)
