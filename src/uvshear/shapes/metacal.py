r"""Metacalibration in the uv plane: a galaxy's data as they would be with a little more shear.

The visibility function V of the galaxy is found from the data (``shapes.deconvolution``), sheared without change of
area, V(k) -> V((1 + G) k), and multiplied by the weight exp(-k^2/2 s^2) of a round beam. The result is a facet to which
any estimator can be applied, and the estimator's response to a shear is a difference between its values for such facets
(Sheldon & Huff 2017, ApJ 841, 24; Huff & Mandelbaum 2017). Shearing the data also shears their noise, whose direction
then looks like that of a galaxy. Noise of the same kind is therefore added, sheared in the opposite direction, so that
to first order the sum has no direction (their sect. 2.3).
"""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.imaging.gridder import visibilities_at
from uvshear.interferometer.facet import Facet
from uvshear.shapes.deconvolution import Disc, EvenPart, OddPart
from uvshear.typing import Array, Complex, Float

WIDEST = 20e3
"""Width s of the round beam where baselines are long enough [wavelengths]."""

REACH = 3.2
"""Longest baseline of the round beam, over s."""

MOST_PIXELS = 2600
"""Largest number of pixels of half of the disc, the unknowns of the deconvolution: its two matrices take 0.1 GB then.
It allows for discs of 56 arcsec with baselines of 65 kilowavelengths."""

MOST_NOISE_CELLS = 512
"""Largest number of cells from which the mean noise of a round beam is computed."""

STEP = 0.02
"""Shear that is applied, with either sign: the remainder of third order is 4e-4 of the response."""


@dataclass(frozen=True)
class ShearedFacets:
    """Facets of one galaxy with a round PSF, without a shear and with shears of ``STEP``.

    Parameters
    ----------
    unsheared
        Facet without a shear.
    sheared
        Facets with a shear: first g1, then g2, each with the positive and the negative sign.
    """

    unsheared: Facet
    sheared: tuple[tuple[Facet, Facet], tuple[Facet, Facet]]


def scale_of(uv: Float[Array, "cell 2"], power: Float[Array, " cell"]) -> float:
    """Width s of a round beam within the baselines that were measured [wavelengths].

    Parameters
    ----------
    uv
        Cells of the facet [wavelengths].
    power
        Power of the beam on these cells; cells below a hundredth of the mean count as not measured.
    """
    longest = np.hypot(*uv[power > 1e-2 * np.mean(power)].T).max()
    return min(WIDEST, float(longest) / (REACH * (1 + STEP)))


class Metacalibration:
    """Makes facets with a round PSF from the facets of one set of cells and one beam.

    Attributes
    ----------
    radius
        Radius of the disc within which the deconvolution is exact [rad].

    Parameters
    ----------
    uv
        Cells of the facets [wavelengths].
    power
        Power of the beam on these cells.
    width
        Width of the facets [rad].
    scale
        Width s of the round beam [wavelengths].
    target
        Cells of the round beam [wavelengths].
    multiplicity
        Number of cells of the whole plane that each target cell stands for.
    """

    def __init__(
        self,
        uv: Float[Array, "cell 2"],
        power: Float[Array, " cell"],
        width: float,
        scale: float,
        target: Float[Array, "target 2"],
        multiplicity: Float[Array, " target"],
    ) -> None:
        longest = REACH * scale * (1 + STEP)
        self._cells = np.flatnonzero(np.hypot(*uv.T) <= longest)
        near, self._power = uv[self._cells], np.abs(power[self._cells])
        self._disc, self._target = Disc(width, longest, MOST_PIXELS), target
        self.radius = self._disc.radius
        self._even, self._odd = (
            part(self._disc, near, power[self._cells]) for part in (EvenPart, OddPart)
        )
        self._index = tuple(self._disc.size // 2 + self._disc.index.T)
        self._mirrored = tuple(self._disc.size // 2 - self._disc.index.T)
        taper = multiplicity * np.exp(-np.sum(target**2, axis=-1) / (2 * scale**2))
        # The noise is smooth: one cell in sixteen is enough to know its mean.
        few = slice(None, None, max(16, len(target) // MOST_NOISE_CELLS))
        noise = 2 * self._even.variance(np.cos(2 * math.pi * target[few] @ self._disc.places.T))
        # The power is such that it describes the noise of the facets on average.
        self._beam = taper * (np.sum(taper[few]) / np.sum(taper[few] ** 2 * noise))

    def size_of(self) -> float:
        """Return the memory that the matrices take [bytes]."""
        return self._even.size_of() + self._odd.size_of()

    def sheared_facets(
        self, correlation: Complex[Array, " cell"], noise: Complex[Array, " cell"]
    ) -> ShearedFacets:
        """Make the facets of one galaxy.

        Parameters
        ----------
        correlation
            Data of the galaxy's facet.
        noise
            Noise to be added, in standard deviations of the facet's own.
        """
        data = self._image(correlation[self._cells])
        added = self._image(np.sqrt(self._power) * noise[self._cells])

        def facet(shear: complex) -> Facet:
            seen = self._seen(data, shear) + self._seen(added, -shear)
            return Facet(self._target, self._beam * seen, self._beam)

        first, second = (
            (facet(STEP * direction), facet(-STEP * direction)) for direction in (1 + 0j, 1j)
        )
        return ShearedFacets(facet(0j), (first, second))

    def _image(self, data: Complex[Array, " cell"]) -> Complex[Array, "l m"]:
        even, odd = self._even.brightness(data.real), self._odd.brightness(data.imag)
        image = np.zeros((self._disc.size, self._disc.size), complex)
        # The central pixel stands for both of its halves.
        image[self._index] = (even + odd) / 2
        image[self._mirrored] += (even - odd) / 2
        return image

    def _seen(self, image: Complex[Array, "l m"], shear: complex) -> Complex[Array, " target"]:
        matrix = np.array([[1 + shear.real, shear.imag], [shear.imag, 1 - shear.real]])
        points = self._target @ matrix / math.sqrt(1 - abs(shear) ** 2)
        return visibilities_at(image, self._disc.pixel, points)
