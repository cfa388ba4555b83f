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


def number_of_terms(
    w: Float[Array, " probe"], image: ImageGrid, error: float, samples: int
) -> int | None:
    """Return the number of products with which an image of a number of samples is made; None for w-planes.

    ``w`` [wavelengths] is that of some of the samples, and ``error`` is the largest rms error.
    """
    found = _Basis.over(image).fewest(w, error)
    return found[0] if found is not None and _are_cheaper(found[0], image, samples) else None


def _are_cheaper(terms: int, image: ImageGrid, samples: int) -> bool:
    amounts = np.array([image.size**2, samples])
    return bool(terms * np.dot(_TERM, amounts) <= np.dot(_PLANES, amounts))


@dataclass(frozen=True)
class _Basis:
    """Polynomials of r^2 that are orthonormal over an image, at the nodes of an integral over the image.

    Parameters
    ----------
    corner
        Square of the distance of the image's corner from its centre [rad^2].
    n_minus_one
        n - 1 at the nodes.
    weighted
        Each polynomial, times the weight of the node.
    triangle
        Upper triangle that gives the powers of t (``WTerms``) from the polynomials.
    """

    corner: float
    n_minus_one: Float[Array, " node"]
    weighted: Float[Array, "node term"]
    triangle: Float[Array, "term power"]

    @classmethod
    def over(cls, image: ImageGrid) -> Self:
        """Return the polynomials over an image, which are worth nothing if it reaches the horizon."""
        corner = min(2 * (image.size * image.pixel / 2) ** 2, 1.0)
        square = (_NODES[:, None] ** 2 + _NODES[None, :] ** 2).ravel() / 2
        share = np.outer(_WEIGHTS, _WEIGHTS).ravel() / 4
        n_minus_one = -corner * square / (1 + np.sqrt(1 - corner * square))
        powers = (2 * square - 1)[:, None] ** np.arange(MOST_TERMS)
        q, triangle = np.linalg.qr(powers * np.sqrt(share)[:, None])
        return cls(corner, n_minus_one, q * np.sqrt(share)[:, None], triangle)

    def projected(self, w: Float[Array, " n"]) -> Complex[Array, "n term"]:
        """Return p_k(w)."""
        return np.exp(2j * math.pi * np.outer(w, self.n_minus_one)) @ self.weighted

    def fewest(
        self, w: Float[Array, " sample"], error: float
    ) -> tuple[int, Float[Array, " term"]] | None:
        """Return the smallest number of products with at most this rms error, and the rms of each p_k(w)."""
        if len(w) == 0:
            return 1, np.ones(1)
        largest = float(np.abs(w).max())
        if self.corner >= 1 or math.pi * self.corner * largest > _LARGEST_PHASE:
            return None
        few = self.projected(w[:: max(1, len(w) // _FEW)])
        square = np.abs(few) ** 2
        left = np.sqrt(np.maximum(1 - np.cumsum(square, axis=1), 0))
        good = np.sqrt(np.mean(left**2, axis=0)) <= error
        good &= left.max(axis=0) <= IN_THE_TAIL * error
        if not good.any():
            return None
        count = int(np.argmax(good)) + 1
        return count, np.sqrt(np.mean(square[:, :count], axis=0))


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
        basis = _Basis.over(image)
        if (found := basis.fewest(w, error)) is None:
            return None
        count, weight = found
        if not _are_cheaper(count, image, len(w)):
            return None
        largest = float(np.abs(w).max(initial=0.0))
        angle = math.pi * (np.arange(_DEGREE) + 0.5) / _DEGREE
        series = np.cos(np.outer(np.arange(_DEGREE), angle)) * (2 / _DEGREE)
        series[0] /= 2
        by_w = (series @ basis.projected(largest * np.cos(angle))).T[:count]
        degrees = int(np.flatnonzero(np.abs(by_w).max(axis=0) > _NEGLIGIBLE).max()) + 1
        return cls(
            by_distance=np.linalg.inv(basis.triangle).T[:count],
            by_w=np.ascontiguousarray(by_w[:, :degrees]),
            largest=largest or 1.0,
            weight=weight,
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
