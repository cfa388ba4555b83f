"""Imaging in the plane tangent at a direction, where w hardly matters: a tile's image, and its adjoint."""

import math
from dataclasses import dataclass
from typing import Self

import ducc0
import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.geometry.directions import n_minus_one
from uvshear.imaging.kernels import to_tangent_plane
from uvshear.typing import Array, Complex, Float

NEGLIGIBLE_PHASE = 0.01
"""Phase pi w x^2 in a tile's corner up to which all baselines lie in one plane [rad]."""

IN_WAVELENGTHS = np.array([SPEED_OF_LIGHT])
"""The frequency at which a metre is a wavelength."""


@dataclass(frozen=True)
class TangentPlane:
    r"""Baselines as seen from (l, m), and their phase there.

    With x the distance from (l, m), w (n - 1) = w (n_0 - 1) - w (l x_l + m x_m)/n_0 - w x^2/2 + ...: the first term
    is a phase, the second a shift of (u, v), the third is what the gridder's w-planes are for. Beyond that
    remains w x^2/2 times about l^2 + m^2: 1e-4 turns in the corner of a tile at 0.7 deg, for w = 3e5.

    Parameters
    ----------
    baselines
        In the gridder's signs: (-u, -v, w) [wavelengths].
    phase
        exp(2 pi i (u l + v m + w (n-1))).
    """

    baselines: Float[Array, "sample 3"]
    phase: Complex[Array, " sample"]

    @classmethod
    def at(cls, uvw: Float[Array, "sample 3"], l: float, m: float) -> Self:
        """See baselines [wavelengths] from a direction."""
        n1 = float(n_minus_one(np.array([l]), np.array([m]))[0])
        baselines = np.empty((len(uvw), 3))
        phase = np.empty(len(uvw), np.complex64)
        real, imaginary = np.empty((2, len(uvw)), np.float32)
        to_tangent_plane(np.ascontiguousarray(uvw), (l, m, n1), baselines, real, imaginary)
        phase.real, phase.imag = real, imaginary
        return cls(baselines, phase)

    def image(
        self, vis: Complex[Array, " sample"], size: int, pixel: float, epsilon: float
    ) -> Float[Array, "l m"]:
        r"""Sum of Re[vis exp(-2 pi i (u l + v m + w (n-1)))] on square pixels about the direction.

        Pixel (i, j) is (i - size/2, j - size/2) pixels away from it; ``vis`` has its weights in it.
        """
        phased = vis * self.phase.conj()
        return ducc0.wgridder.vis2dirty(
            uvw=self.baselines,
            freq=IN_WAVELENGTHS,
            vis=phased[:, None].astype(np.complex64, copy=False),
            npix_x=size,
            npix_y=size,
            pixsize_x=pixel,
            pixsize_y=pixel,
            epsilon=epsilon,
            do_wgridding=self._needs_w(size * pixel / 2),
            divide_by_n=False,
            nthreads=1,
        )

    def beam(
        self, weights: Complex[Array, " sample"], size: int, pixel: float, epsilon: float
    ) -> Float[Array, "l m"]:
        """Image of a unit point source at the direction, in one plane: w is negligible so near."""
        return ducc0.wgridder.vis2dirty(
            uvw=self.baselines,
            freq=IN_WAVELENGTHS,
            vis=weights[:, None],
            npix_x=size,
            npix_y=size,
            pixsize_x=pixel,
            pixsize_y=pixel,
            epsilon=epsilon,
            do_wgridding=False,
            divide_by_n=False,
            nthreads=1,
        )

    def visibilities(
        self, image: Float[Array, "l m"], pixel: float, epsilon: float
    ) -> Complex[Array, " sample"]:
        """Sum of image exp(+2 pi i (u l + v m + w (n-1))): the adjoint of :meth:`image`."""
        vis = ducc0.wgridder.dirty2vis(
            uvw=self.baselines,
            freq=IN_WAVELENGTHS,
            dirty=image,
            pixsize_x=pixel,
            pixsize_y=pixel,
            epsilon=epsilon,
            do_wgridding=self._needs_w(len(image) * pixel / 2),
            divide_by_n=False,
            nthreads=1,
        )
        return vis[:, 0] * self.phase

    def _needs_w(self, half_width: float) -> bool:
        w_max = float(np.abs(self.baselines[:, 2]).max(initial=0.0))
        return math.pi * w_max * 2 * half_width**2 > NEGLIGIBLE_PHASE
