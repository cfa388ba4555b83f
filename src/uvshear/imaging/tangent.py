"""Imaging in the plane tangent at a direction, where w hardly matters: the image of a tile, and its adjoint."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.geometry.directions import n_minus_one_at
from uvshear.imaging.curvature import mean_curvature, touching_point
from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.gridder import degrid, grid
from uvshear.imaging.kernels import to_tangent_plane
from uvshear.imaging.w_terms import WTerms
from uvshear.typing import Array, Complex, Float

COARSEST = 1e-2
"""Largest relative error of the gridder for terms of w that contribute little."""

IN_WAVELENGTHS = np.array([SPEED_OF_LIGHT])
"""Frequency at which a baseline of one metre is one wavelength long [Hz]."""


@dataclass(frozen=True)
class TangentPlane:
    r"""Baselines as seen from a direction (l, m), and the phase of a source there.

    With x the distance from (l, m), w (n - 1) = w (n_0 - 1) - w (l x_l + m x_m)/n_0 - w c x^2/2 + ...: the first term
    is a phase, the second is a shift of (u, v), and the gridder's w-planes take the third into account, in which c is
    the mean curvature of n. The remainder limits the width of tiles (``imaging.curvature``).

    Parameters
    ----------
    baselines
        (u - w l/n, v - w m/n, c w) [wavelengths].
    phase
        exp(2 pi i (u l + v m + w (n-1))).
    """

    baselines: Float[Array, "sample 3"]
    phase: Complex[Array, " sample"]

    @classmethod
    def at(cls, uvw: Float[Array, "sample 3"], l: float, m: float) -> Self:
        """Baselines ``uvw`` [wavelengths] as seen from the direction (l, m).

        Beyond the horizon, where there is no tangent, n is continued linearly from the nearest direction above it.
        """
        l0, m0, n0 = touching_point(l, m)
        n1 = n_minus_one_at(l0, m0)
        slopes = l0 / n0, m0 / n0
        n1 -= slopes[0] * (l - l0) + slopes[1] * (m - m0)
        baselines = np.empty((len(uvw), 3))
        phase = np.empty(len(uvw), np.complex64)
        real, imaginary = np.empty((2, len(uvw)), np.float32)
        to_tangent_plane(
            np.ascontiguousarray(uvw),
            (l, m, n1),
            (*slopes, mean_curvature(n0)),
            baselines,
            real,
            imaginary,
        )
        phase.real, phase.imag = real, imaginary
        return cls(baselines, phase)

    def image(
        self, vis: Complex[Array, " sample"], size: int, pixel: float, epsilon: float
    ) -> Float[Array, "l m"]:
        r"""Sum of Re[vis exp(-2 pi i (u l + v m + w (n-1)))] on square pixels about the direction.

        Pixel (i, j) is (i - size/2, j - size/2) pixels away from the direction.

        Parameters
        ----------
        vis
            Visibilities, multiplied by their weights.
        size
            Number of pixels along a side.
        pixel
            Width of a pixel [rad].
        epsilon
            Relative error of the gridder.
        """
        phased = (vis * self.phase.conj()).astype(np.complex64, copy=False)
        pixels, w = ImageGrid(size, pixel), self.baselines[:, 2]
        terms = WTerms.within(w, pixels, epsilon)
        if terms is None:
            return self._grid(phased, pixels, epsilon, with_w=True)
        total = np.zeros((size, size), np.float32)
        for k, weight in enumerate(terms.weight.tolist()):
            part = self._grid(terms.weighted(k, w, phased), pixels, _relaxed(epsilon, weight))
            terms.add_image(k, part, total)
        return total

    def beam(
        self, weights: Complex[Array, " sample"], size: int, pixel: float, epsilon: float
    ) -> Float[Array, "l m"]:
        """Image of a unit point source at the direction; w is neglected, since the image is small.

        Parameters
        ----------
        weights
            Weights of the samples, with an imaginary part of zero.
        size
            Number of pixels along a side.
        pixel
            Width of a pixel [rad].
        epsilon
            Relative error of the gridder.
        """
        return self._grid(weights, ImageGrid(size, pixel), epsilon)

    def visibilities(
        self, image: Float[Array, "l m"], pixel: float, epsilon: float
    ) -> Complex[Array, " sample"]:
        """Sum of image exp(+2 pi i (u l + v m + w (n-1))), the adjoint of :meth:`image`."""
        pixels, w = ImageGrid(len(image), pixel), self.baselines[:, 2]
        terms = WTerms.within(w, pixels, epsilon)
        if terms is None:
            return self._degrid(image, pixels, epsilon, with_w=True) * self.phase
        total = np.zeros(len(w), np.complex64)
        for k, weight in enumerate(terms.weight.tolist()):
            part = self._degrid(terms.image(k, image), pixels, _relaxed(epsilon, weight))
            terms.add_weighted(k, w, part, total)
        return total * self.phase

    def _grid(
        self,
        vis: Complex[Array, " sample"],
        image: ImageGrid,
        epsilon: float,
        *,
        with_w: bool = False,
    ) -> Float[Array, "l m"]:
        return grid(
            self.baselines, IN_WAVELENGTHS, vis[:, None], image, epsilon=epsilon, with_w=with_w
        )

    def _degrid(
        self,
        pixels: Float[Array, "l m"],
        image: ImageGrid,
        epsilon: float,
        *,
        with_w: bool = False,
    ) -> Complex[Array, " sample"]:
        vis = degrid(self.baselines, IN_WAVELENGTHS, pixels, image, epsilon=epsilon, with_w=with_w)
        return vis[:, 0]


def _relaxed(epsilon: float, weight: float) -> float:
    """Relative error that a term of this weight may have."""
    return min(epsilon / weight, max(epsilon, COARSEST)) if weight > 0 else COARSEST
