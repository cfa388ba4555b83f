r"""The term w (n - 1) over a small image, as a sum of a few products.

.. math:: e^{2\pi i\, w (n - 1)} = \sum_k p_k(w)\, q_k(r^2)

with r the distance from the image's centre. The q_k are real polynomials of rising degree that are orthonormal over the
pixels, and p_k(w) is the mean of the left-hand side times q_k over them: with K of them, the sum has the smallest rms
error of all sums over polynomials of degree K - 1. An image without w, whose gridding takes a fifth of the time or
less, is needed for each k. The gridder's w-planes (Arras et al. 2021, A&A 646, A58) number at least as many as its
kernel has cells; in a tile that w turns by one radian, four products are enough.
"""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.imaging import kernels
from uvshear.imaging.grid import ImageGrid
from uvshear.typing import Array, Complex, Float

MOST_TERMS = 6
"""Largest number of products that is considered."""

_TERM, _PLANES = (19.0, 120.0), (118.0, 380.0)
"""Costs of a pixel and of a sample on one core [ns]: for each product, and for all w-planes together."""

IN_THE_TAIL = 10.0
"""Largest error of a single baseline, over the root mean square of the error that is allowed."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)

_FEW = 256
"""Number of baselines whose errors are estimated."""

_DEGREE = 24
"""Number of Chebyshev polynomials that represent p_k(w); for phases of up to 6 rad, their error is 1e-9."""

_LARGEST_PHASE = 6.0
"""Phase in the corner of an image, for the largest w, beyond which w-planes are cheaper [rad]."""

_NEGLIGIBLE = 1e-9
"""Coefficient below which a Chebyshev polynomial is left out."""


@dataclass(frozen=True)
class WTerms:
    """The products for one image.

    Parameters
    ----------
    by_distance
        Coefficients of each q_k in powers of t, which is -1 at the centre of the image and 1 in its corners, where
        t + 1 is proportional to r^2.
    by_w
        Coefficients of each p_k in Chebyshev polynomials of w over ``largest``.
    largest
        Largest modulus of w [wavelengths].
    weight
        Root mean square of each p_k over the baselines; that of q_k over the pixels is 1.
    """

    by_distance: Float[Array, "term power"]
    by_w: Complex[Array, "term degree"]
    largest: float
    weight: Float[Array, " term"]

    @classmethod
    def within(cls, w: Float[Array, " sample"], image: ImageGrid, error: float) -> Self | None:
        """Find the products for baselines with these w [wavelengths], and an image about the direction (0, 0).

        Returns
        -------
        WTerms or None
            The fewest products with at most this error in the root mean square, over baselines and pixels; None where
            w-planes are cheaper.
        """
        corner = 2 * (image.size * image.pixel / 2) ** 2
        largest = float(np.abs(w).max(initial=0.0))
        if corner >= 1 or math.pi * corner * largest > _LARGEST_PHASE:
            return None
        square = (_NODES[:, None] ** 2 + _NODES[None, :] ** 2).ravel() / 2
        share = np.outer(_WEIGHTS, _WEIGHTS).ravel() / 4
        n1 = -corner * square / (1 + np.sqrt(1 - corner * square))
        powers = (2 * square - 1)[:, None] ** np.arange(MOST_TERMS)
        q, triangle = np.linalg.qr(powers * np.sqrt(share)[:, None])
        q *= np.sqrt(share)[:, None]

        def projected(w: Float[Array, " n"]) -> Complex[Array, "n term"]:
            return np.exp(2j * math.pi * np.outer(w, n1)) @ q

        few = projected(w[:: max(1, len(w) // _FEW)])
        left = np.sqrt(np.maximum(1 - np.cumsum(np.abs(few) ** 2, axis=1), 0))
        good = np.sqrt(np.mean(left**2, axis=0)) <= error
        good &= left.max(axis=0) <= IN_THE_TAIL * error
        if not good.any():
            return None
        count = int(np.argmax(good)) + 1
        amounts = np.array([image.size**2, len(w)])
        if count * np.dot(_TERM, amounts) > np.dot(_PLANES, amounts):
            return None
        angle = math.pi * (np.arange(_DEGREE) + 0.5) / _DEGREE
        series = np.cos(np.outer(np.arange(_DEGREE), angle)) * (2 / _DEGREE)
        series[0] /= 2
        by_w = (series @ projected(largest * np.cos(angle))).T[:count]
        degrees = int(np.flatnonzero(np.abs(by_w).max(axis=0) > _NEGLIGIBLE).max()) + 1
        return cls(
            by_distance=np.linalg.inv(triangle).T[:count],
            by_w=np.ascontiguousarray(by_w[:, :degrees]),
            largest=largest or 1.0,
            weight=np.sqrt(np.mean(np.abs(few[:, :count]) ** 2, axis=0)),
        )

    def __len__(self) -> int:
        return len(self.weight)

    def weighted(
        self, k: int, w: Float[Array, " sample"], vis: Complex[Array, " sample"]
    ) -> Complex[Array, " sample"]:
        """Visibilities times the conjugate of p_k(w), whose images are to be added."""
        total = np.zeros_like(vis)
        kernels.add_times_series(w, 1 / self.largest, self.by_w[k].conj(), vis, total)
        return total

    def add_weighted(
        self,
        k: int,
        w: Float[Array, " sample"],
        vis: Complex[Array, " sample"],
        total: Complex[Array, " sample"],
    ) -> None:
        """Add visibilities of the k-th image, times p_k(w)."""
        kernels.add_times_series(w, 1 / self.largest, self.by_w[k], vis, total)

    def add_image(self, k: int, part: Float[Array, "l m"], total: Float[Array, "l m"]) -> None:
        """Add an image times q_k."""
        kernels.add_times_polynomial(self.by_distance[k, : k + 1], part, total)

    def image(self, k: int, pixels: Float[Array, "l m"]) -> Float[Array, "l m"]:
        """Return an image times q_k."""
        total = np.zeros_like(pixels)
        self.add_image(k, pixels, total)
        return total
