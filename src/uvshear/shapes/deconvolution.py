r"""Linear functionals of a source that is much smaller than its facet: exact, and with the least noise.

The visibility function V of a source is not measured everywhere: between the tracks of a few baselines the power of the
beam is nearly zero, so that the data cannot be divided by it. But a galaxy is small, so that V is smooth. With x the
pixels of a disc that holds the galaxy, B the dirty beam between them, and t any linear functional of V, given by its
values t(x) for point sources at x, the weights on the data

.. math:: w_k = \sum_x b_x e^{2 \pi i k x},\quad \sum_{x'} B_{xx'} b_{x'} = t_x

give that functional for every brightness distribution within the disc, and no other weights that do so have less noise.
The even part of the brightness is in the real part of the data, the odd part in the imaginary part.

Cells are whole multiples of 1/width and pixels are whole multiples of width/size, so that all sums over cells or pixels
are discrete Fourier transforms of ``size`` by ``size`` numbers. The matrix B is the only thing that grows with the
square of the number of pixels, which is limited (``Disc``).
"""

import math

import numpy as np
from scipy import fft
from scipy.linalg import cho_factor, cho_solve

from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Complex, Float, Int

DISC = 0.35
"""Radius of the disc over the width of the facet. It is 16 scale lengths: moments of galaxies 1.5 times as large as the
median are right to 1e-3, those of smaller ones to 1e-4."""

LEAST_SCALE_LENGTHS = 10.0
"""Smallest radius of a disc over the median scale length of a source, below which the source has no statistic. With 10
scale lengths of a galaxy in its disc, the moments are right to 1e-3 of M_R, with 5 to 2e-2."""

_OVERSAMPLING = 1.15
"""Pixels along a side over the number that Nyquist's theorem requires."""

_RIDGE = 1e-8
"""Part of the power that is added to the diagonal of the matrix to make up for rounding."""


def holds(radius: float, prior: ShapePrior) -> bool:
    """Whether a disc of this radius [rad] holds a source of median size, all but a negligible part of its flux."""
    # The discs of equal facets differ by rounding.
    return radius > LEAST_SCALE_LENGTHS * math.exp(prior.log_scale_length) * (1 - 1e-6)


class Disc:
    """Pixels that hold a small source, as fine as the longest baseline requires.

    The radius is ``DISC`` times the width of the facet, or less if there would be more pixels than allowed.

    Parameters
    ----------
    width
        Width of the facet [rad].
    longest
        Longest baseline on which functionals of V are evaluated [wavelengths].
    most
        Largest number of pixels in half of the disc, which is the number of unknowns.
    """

    def __init__(self, width: float, longest: float, most: int) -> None:
        self.width = width
        self.size = max(math.ceil(width * 2 * longest * _OVERSAMPLING), 1)
        self.pixel = width / self.size
        self.radius = min(DISC * width, math.sqrt(2 * most / math.pi) * self.pixel)
        """Radius of the disc [rad]."""
        index = np.arange(self.size) - self.size // 2
        grid = np.stack(np.meshgrid(index, index, indexing="ij"), axis=-1).reshape(-1, 2)
        # An even or odd brightness is known from half of the disc.
        half = (grid[:, 0] > 0) | ((grid[:, 0] == 0) & (grid[:, 1] >= 0))
        self.index = grid[half & (np.hypot(*grid.T) * self.pixel < self.radius)]
        """Indices of the pixels, counted from the centre."""

    @property
    def places(self) -> Float[Array, "pixel 2"]:
        """Positions of the pixels relative to the centre [rad]."""
        return self.index * self.pixel

    def harmonics(self, uv: Float[Array, "cell 2"]) -> Int[Array, "cell 2"]:
        """Cells [wavelengths] as whole multiples of one over the width."""
        harmonics = np.rint(uv * self.width).astype(int)
        if np.abs(uv * self.width - harmonics).max(initial=0.0) > 1e-3:
            raise ValueError("the cells are not those of a facet of this width")
        return harmonics


class EvenPart:
    """Functionals of the even part of a small source's brightness, from the real part of its data.

    Parameters
    ----------
    disc
        Pixels that hold the source.
    uv
        Cells of the facet, whole multiples of one over its width [wavelengths].
    power
        Power of the beam on these cells, at least one of which has some.
    """

    parity = 1
    """Sign that the brightness takes at the opposite place."""

    def __init__(
        self, disc: Disc, uv: Float[Array, "cell 2"], power: Float[Array, " cell"]
    ) -> None:
        self._size = disc.size
        self._pixels = tuple((disc.index % disc.size).T)
        self._cells = tuple((disc.harmonics(uv) % disc.size).T)
        # A beam cut out of its image has a little negative power in the gaps; its modulus is the noise there.
        self._noise = np.abs(power)
        self._sign = np.sign(power)
        self._unit = float(self._noise.max())
        beam = self._transform(self._cells, self._noise / self._unit).real
        matrix = self._between_pixels(disc.index, beam)
        # The sine has no power at the centre.
        diagonal = np.maximum(np.diag(matrix), np.finfo(float).tiny)
        self._ridge = _RIDGE * diagonal
        matrix[np.diag_indices_from(matrix)] = diagonal + self._ridge
        self._factor = cho_factor(matrix, lower=True, overwrite_a=True, check_finite=False)

    def size_of(self) -> float:
        """Return the memory that the factor of the matrix takes [bytes]."""
        return self._factor[0].nbytes

    def weights(self, targets: Float[Array, "target pixel"]) -> Float[Array, "target cell"]:
        """Weights on the data that sum to functionals with these values for points at the disc's pixels."""
        solutions = cho_solve(self._factor, targets.T).T
        sums = [self._wave_sum(self._pixels, solution, self._cells) for solution in solutions]
        return np.stack(sums) * (self._sign / self._unit)

    def variance(self, targets: Float[Array, "target pixel"]) -> Float[Array, " target"]:
        """Variance of the functionals due to noise."""
        solution = cho_solve(self._factor, targets.T)
        # The noise of the weights is b B b, and B b + ridge b = t.
        product = targets.T * solution - self._ridge[:, None] * solution**2
        return np.sum(product, axis=0) / self._unit

    def values_at_pixels(
        self, cell_weights: Float[Array, "target cell"]
    ) -> Float[Array, "target pixel"]:
        """Values, for points at the disc's pixels, of weighted sums of V over the cells of the facet."""
        return np.stack(
            [self._wave_sum(self._cells, weights, self._pixels) for weights in cell_weights]
        )

    def brightness(self, data: Float[Array, " cell"]) -> Float[Array, " pixel"]:
        """Brightness of least noise on the disc that reproduces the data."""
        seen = self._wave_sum(self._cells, data * (self._sign / self._unit), self._pixels)
        return cho_solve(self._factor, seen)

    def _between_pixels(
        self, index: Int[Array, "pixel 2"], beam: Float[Array, "size size"]
    ) -> Float[Array, "pixel pixel"]:
        """Beam between all pairs of pixels, of which the lower triangle is filled.

        cos kx cos kx' is half of cos k(x - x') + cos k(x + x'), and sin kx sin kx' half of their difference.
        """
        matrix = np.zeros((len(index), len(index)), order="F")
        for column, pixel in enumerate(index):
            later = index[column:]
            apart, together = ((later - pixel) % self._size).T, ((later + pixel) % self._size).T
            difference, total = beam[tuple(apart)], beam[tuple(together)]
            matrix[column:, column] = (difference + self.parity * total) / 2
        return matrix

    def _transform(
        self, places: tuple[Int[Array, " place"], ...], values: Float[Array, " place"]
    ) -> Complex[Array, "size size"]:
        grid = np.zeros((self._size, self._size))
        np.add.at(grid, places, values)
        return fft.fft2(grid, overwrite_x=True)

    def _wave_sum(
        self,
        places: tuple[Int[Array, " place"], ...],
        values: Float[Array, " place"],
        at: tuple[Int[Array, " point"], ...],
    ) -> Float[Array, " point"]:
        """Sum of values with the cosines of their phases, or with the sines for the odd part."""
        transform = self._transform(places, values)[at]
        return transform.real if self.parity > 0 else -transform.imag


class OddPart(EvenPart):
    """Functionals of the odd part of a small source's brightness, from the imaginary part of its data."""

    parity = -1
