"""Facets cut out of images: a square of pixels, its Fourier transform, and the half of the uv plane that is kept."""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy import fft

from uvshear.imaging import kernels
from uvshear.numerics.fft_sizes import fast_size
from uvshear.numerics.half_plane import HalfPlane, half_plane
from uvshear.numerics.real_transforms import half_spectrum
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
        facet = np.zeros(len(self._scale), np.result_type(square.dtype, np.complex64))
        everywhere = np.arange(len(facet))
        kernels.gather_cells(half_spectrum(paired), *self.cells, self._scale, everywhere, facet)
        return facet

    @cached_property
    def resolved_cells(self) -> Int[Array, " low"]:
        """Cells that pixels twice as wide resolve."""
        half = self.size // 2
        i, j = self.cells
        signed = np.where(i > half, i - self.size, i)
        return np.flatnonzero((np.abs(signed) < half // 2) & (j < half // 2))

    @cached_property
    def _coarse(self) -> tuple[Int[Array, " low"], Int[Array, " low"], Float[Array, " low"]]:
        """Positions of these cells in the transform of a square of wide pixels, and their scale."""
        low, half = self.resolved_cells, self.size // 2
        i, j = (index[low] for index in self.cells)
        i = np.where(i > half, i - self.size, i) % half
        sign = np.where((i + j) % 2, -1, 1)
        return i, j, (4 / self.size**2 * self.multiplicity[low] * sign).astype(np.float32)

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
        paired = square.copy()
        paired[0, :] = paired[:, 0] = 0
        i, j, scale = self._coarse
        kernels.gather_cells(
            half_spectrum(paired), i, j, np.float32(factor) * scale, self.resolved_cells, facet
        )

    def recentre(self, facet: Complex[Array, " cell"], offset: tuple[float, float]) -> None:
        """Move a facet's centre by ``offset`` [rad], in place."""
        u, v = fft.fftfreq(self.size, self.pixel), fft.rfftfreq(self.size, self.pixel)
        along_u, along_v = (
            np.exp(-2j * math.pi * x * k).astype(np.complex64)
            for x, k in zip(offset, (u, v), strict=True)
        )
        kernels.turn_cells(along_u, along_v, *self.cells, facet)


@lru_cache(maxsize=1024)
def cutout(size: int, pixel: float, shortest: float, longest: float) -> Cutout:
    """Return one cutout for the same numbers, so that sources share their cells."""
    return Cutout(size, pixel, shortest, longest)


def cutout_size(width: float, pixel: float) -> int:
    """Find a number of pixels for a width [rad] that is quick to transform, on pixels twice as wide too."""
    return fast_size(max(width / pixel, 32), multiple=4)
