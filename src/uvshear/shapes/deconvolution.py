r"""Linear functionals of a source that is much smaller than its facet: exact, and with the least noise.

The visibility function V of a source is not measured everywhere: between the tracks of a few baselines the power of the
beam is nearly zero, so that the data cannot be divided by it. But a galaxy is small, so that V is smooth. With x the
pixels of a disc that holds the galaxy, B the dirty beam between them, and t any linear functional of V, given by its
values t(x) for point sources at x, the weights on the data

.. math:: w_k = \sum_x b_x e^{2 \pi i k x},\quad \sum_{x'} B_{xx'} b_{x'} = t_x

give that functional for every brightness distribution within the disc, and no other weights that do so have less noise.
The even part of the brightness is in the real part of the data, the odd part in the imaginary part.
"""

import math

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from uvshear.typing import Array, Float

DISC = 0.35
"""Radius of the disc over the width of the facet. It is 16 scale lengths: moments of galaxies 1.5 times as large as the
median are right to 1e-3, those of smaller ones to 1e-4."""


class Disc:
    """Pixels that hold a small source, as fine as the longest baseline requires.

    Parameters
    ----------
    width
        Width of the facet [rad].
    longest
        Longest baseline on which functionals of V are evaluated [wavelengths].
    """

    def __init__(self, width: float, longest: float) -> None:
        oversampling = 1.15
        self.size = math.ceil(width * 2 * longest * oversampling)
        self.pixel = width / self.size
        index = np.arange(self.size) - self.size // 2
        grid = np.stack(np.meshgrid(index, index, indexing="ij"), axis=-1).reshape(-1, 2)
        # An even or odd brightness is known from half of the disc.
        half = (grid[:, 0] > 0) | ((grid[:, 0] == 0) & (grid[:, 1] >= 0))
        self.index = grid[half & (np.hypot(*grid.T) * self.pixel < DISC * width)]
        """Indices of the pixels, counted from the centre."""

    @property
    def places(self) -> Float[Array, "pixel 2"]:
        """Positions of the pixels relative to the centre [rad]."""
        return self.index * self.pixel


class EvenPart:
    """Functionals of the even part of a small source's brightness, from the real part of its data.

    Parameters
    ----------
    disc
        Pixels that hold the source.
    uv
        Cells of the facet [wavelengths].
    power
        Power of the beam on these cells.
    """

    wave = staticmethod(np.cos)

    def __init__(
        self, disc: Disc, uv: Float[Array, "cell 2"], power: Float[Array, " cell"]
    ) -> None:
        self._wave = self.wave(2 * math.pi * disc.places @ uv.T)
        # A beam cut out of its image has a little negative power in the gaps; its modulus is the noise there.
        self._noise = np.abs(power)
        self._sign = np.sign(power)
        unit = self._noise.max()
        beam = (self._wave * (self._noise / unit)) @ self._wave.T
        # The sine has no power at the centre.
        diagonal = np.maximum(np.diag(beam), np.finfo(float).tiny)
        ridge = 1e-8  # part of the power that is added to make up for rounding
        beam[np.diag_indices_from(beam)] = diagonal * (1 + ridge)
        self._factor, self._unit = cho_factor(beam, overwrite_a=True), unit

    def weights(self, targets: Float[Array, "target pixel"]) -> Float[Array, "target cell"]:
        """Weights on the data that sum to functionals with these values for points at the disc's pixels."""
        solution = cho_solve(self._factor, targets.T)
        return self._sign * (self._wave.T @ solution).T / self._unit

    def variance(self, targets: Float[Array, "target pixel"]) -> Float[Array, " target"]:
        """Variance of the functionals due to noise."""
        return np.sum(self.weights(targets) ** 2 * self._noise, axis=1)

    def values_at_pixels(
        self, cell_weights: Float[Array, "target cell"]
    ) -> Float[Array, "target pixel"]:
        """Values, for points at the disc's pixels, of weighted sums of V over the cells of the facet."""
        return cell_weights @ self._wave.T

    def image(self) -> Float[Array, "pixel cell"]:
        """Matrix that takes the data to the brightness of least noise on the disc that reproduces them."""
        right = self._wave * (self._sign / self._unit)
        return cho_solve(self._factor, right)


class OddPart(EvenPart):
    """Functionals of the odd part of a small source's brightness, from the imaginary part of its data."""

    wave = staticmethod(np.sin)
