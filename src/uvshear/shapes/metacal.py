r"""A galaxy's data as they would be behind a little more shear: metacalibration in the uv plane.

Its visibility function V is found from the data (``fit.deconvolution``), sheared, V(k) -> V((1 + G) k) without
change of area, and seen through a round beam with weight exp(-k^2/2 s^2): a facet on which any estimator can work. An
estimator's response to the shear is then a difference of what it makes of such facets (Sheldon & Huff 2017, ApJ 841,
24; Huff & Mandelbaum 2017). Shearing the data shears their noise too, whose direction looks like a galaxy's: noise of
the same kind is added, sheared the other way round, so that to first order the sum has none (their sect. 2.3).
"""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.imaging.gridder import visibilities_at
from uvshear.interferometer.facet import Facet
from uvshear.shapes.deconvolution import Disc, EvenPart, OddPart
from uvshear.typing import Array, Complex, Float

WIDEST = 20e3
"""s [wavelengths], where baselines are long enough."""

REACH = 3.2
"""Longest baseline of the round beam, over s."""

STEP = 0.02
"""Shear that is put on, to either side: what is left of the third order is 4e-4 of the response."""

_FAINTEST = 1e-2
"""Of a cell's mean power: what has less counts as beyond the longest baseline."""

_FEW = 16
"""Every so many cells are looked at for the noise."""


@dataclass(frozen=True)
class ShearedFacets:
    """One galaxy: as it is, and behind shears of ``STEP``; rows are g1, g2, columns + and -."""

    still: Facet
    moved: tuple[tuple[Facet, Facet], tuple[Facet, Facet]]


def scale_of(uv: Float[Array, "cell 2"], power: Float[Array, " cell"]) -> float:
    """Width s of the round beam [wavelengths]: no wider than what was measured."""
    longest = np.hypot(*uv[power > _FAINTEST * np.mean(power)].T).max()
    return min(WIDEST, float(longest) / (REACH * (1 + STEP)))


class Metacalibration:
    """Facets behind a round beam, from those of one set of cells and one beam."""

    def __init__(
        self,
        uv: Float[Array, "cell 2"],
        power: Float[Array, " cell"],
        width: float,
        scale: float,
        target: Float[Array, "target 2"],
        multiplicity: Float[Array, " target"],
    ) -> None:
        """For facets ``width`` wide [rad], and a round beam of ``scale`` [wavelengths].

        ``target`` are the round beam's cells [wavelengths], counted so often.
        """
        longest = REACH * scale * (1 + STEP)
        self._cells = np.flatnonzero(np.hypot(*uv.T) <= longest)
        near, self._power = uv[self._cells], np.abs(power[self._cells])
        self._disc, self._target = Disc(width, longest), target
        even, odd = (part(self._disc, near, power[self._cells]) for part in (EvenPart, OddPart))
        self._even, self._odd = even.image(), odd.image()
        self._index = tuple(self._disc.size // 2 + self._disc.index.T)
        self._mirrored = tuple(self._disc.size // 2 - self._disc.index.T)
        taper = multiplicity * np.exp(-np.sum(target**2, axis=-1) / (2 * scale**2))
        few = slice(None, None, _FEW)
        noise = 2 * even.variance(np.cos(2 * math.pi * target[few] @ self._disc.places.T))
        # As much power as makes for the noise that there is, on average.
        self._beam = taper * (np.sum(taper[few]) / np.sum(taper[few] ** 2 * noise))

    def of(
        self, correlation: Complex[Array, " cell"], noise: Complex[Array, " cell"]
    ) -> ShearedFacets:
        """Facets of one galaxy; ``noise``, in standard deviations of the facet's own, is added."""
        data = self._image(correlation[self._cells])
        more = self._image(np.sqrt(self._power) * noise[self._cells])

        def facet(shear: complex) -> Facet:
            seen = self._seen(data, shear) + self._seen(more, -shear)
            return Facet(self._target, self._beam * seen, self._beam)

        first_moved, second_moved = (
            (facet(STEP * way), facet(-STEP * way)) for way in (1 + 0j, 1j)
        )
        return ShearedFacets(facet(0j), (first_moved, second_moved))

    def _image(self, data: Complex[Array, " cell"]) -> Complex[Array, "l m"]:
        even, odd = self._even @ data.real, self._odd @ data.imag
        image = np.zeros((self._disc.size, self._disc.size), complex)
        # The centre stands for both of its halves.
        image[self._index] = (even + odd) / 2
        image[self._mirrored] += (even - odd) / 2
        return image

    def _seen(self, image: Complex[Array, "l m"], shear: complex) -> Complex[Array, " target"]:
        matrix = np.array([[1 + shear.real, shear.imag], [shear.imag, 1 - shear.real]])
        points = self._target @ matrix / math.sqrt(1 - abs(shear) ** 2)
        return visibilities_at(image, self._disc.pixel, points)
