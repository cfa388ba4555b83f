"""Second moments of a PSF within apertures of different kinds and widths.

The moments of a PSF over the whole plane are zero, because they are derivatives of the weights at u = v = 0, where
there is no baseline. Every size R of a PSF is therefore that of an aperture.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.interferometer.psf_shape import ellipticity_of, measure_psf
from uvshear.typing import Array, Float

SIGMAS: Final = tuple(0.25 * k * ARCSEC for k in range(8, 17))
"""Standard deviations of Gaussian windows that are tried, 2 to 4 arcsec [rad]."""

EDGES: Final = tuple(0.25 * k * ARCSEC for k in range(12, 37))
"""Distances of the edge from the centre that are tried for windows without a weight, 3 to 9 arcsec [rad]."""


class PsfAperture(ABC):
    """A window of some width within which the moments of a PSF are measured.

    Attributes
    ----------
    name
        Description for the reader.
    of_width
        Description of one window, with a place for its width in arcsec.
    widths
        Widths that are tried [rad].
    """

    name: ClassVar[str]
    of_width: ClassVar[str]
    widths: ClassVar[tuple[float, ...]]

    def words(self, width: float) -> str:
        """Describe the window of a width [rad]."""
        return self.of_width.format(width / ARCSEC)

    @abstractmethod
    def moments(
        self, image: Float[Array, "l m"], pixel: float, width: float
    ) -> tuple[complex, float]:
        """Return the ellipticity and R = Q_ll + Q_mm [rad^2]; NaN where the moments are not positive.

        Parameters
        ----------
        image
            Centred image of the PSF.
        pixel
            Width of a pixel [rad].
        width
            Width of the window [rad].
        """


class AdaptiveGaussian(PsfAperture):
    """A Gaussian that has the ellipticity of the PSF, and a fixed area."""

    name = "Gaussian with the ellipticity of the PSF"
    of_width = "Gaussian of standard deviation {:.2f} arcsec with the ellipticity of the PSF"
    widths = SIGMAS

    def moments(
        self, image: Float[Array, "l m"], pixel: float, width: float
    ) -> tuple[complex, float]:
        """Return ellipticity and R."""
        try:
            shape = measure_psf(image, pixel, width)
        except InputError:
            return complex(np.nan, np.nan), float("nan")
        return shape.ellipticity, shape.size


class RoundGaussian(PsfAperture):
    """A round Gaussian."""

    name = "round Gaussian"
    of_width = "round Gaussian of standard deviation {:.2f} arcsec"
    widths = SIGMAS

    def moments(
        self, image: Float[Array, "l m"], pixel: float, width: float
    ) -> tuple[complex, float]:
        """Return ellipticity and R."""
        l, m = _offsets(len(image), pixel)
        return moments_within(image * np.exp(-(l**2 + m**2) / (2 * width**2)), pixel)


class UnweightedDisc(PsfAperture):
    """A disc without a weight."""

    name = "disc"
    of_width = "disc of radius {:.2f} arcsec"
    widths = EDGES

    def moments(
        self, image: Float[Array, "l m"], pixel: float, width: float
    ) -> tuple[complex, float]:
        """Return ellipticity and R."""
        l, m = _offsets(len(image), pixel)
        return moments_within(image * (l**2 + m**2 <= width**2), pixel)


class UnweightedSquare(PsfAperture):
    """A square without a weight, as a cut image would be."""

    name = "square"
    of_width = "square of half-side {:.2f} arcsec"
    widths = EDGES

    def moments(
        self, image: Float[Array, "l m"], pixel: float, width: float
    ) -> tuple[complex, float]:
        """Return ellipticity and R."""
        l, m = _offsets(len(image), pixel)
        return moments_within(
            image * ((np.abs(l) <= width) & (np.abs(m) <= width)),
            pixel,
        )


APERTURES = (AdaptiveGaussian(), RoundGaussian(), UnweightedDisc(), UnweightedSquare())
"""All kinds of apertures that are tried."""


@dataclass(frozen=True)
class SizesInApertures:
    """R of a PSF in apertures of increasing widths, or any other rising function.

    Parameters
    ----------
    width
        Widths [rad].
    size
        R at each width [rad^2].
    """

    width: Float[Array, " width"]
    size: Float[Array, " width"]

    def width_of(self, size: float) -> float:
        """Return the smallest width at which R has this value, by linear interpolation; NaN if there is none."""
        above = np.flatnonzero(self.size >= size)
        if len(above) == 0 or above[0] == 0:
            return float("nan")
        k = int(above[0])
        fraction = (size - self.size[k - 1]) / (self.size[k] - self.size[k - 1])
        return float(self.width[k - 1] + fraction * (self.width[k] - self.width[k - 1]))


def moments_within(weighted: Float[Array, "l m"], pixel: float) -> tuple[complex, float]:
    """Return the ellipticity and R [rad^2] of an image that is multiplied by its window; NaN unless positive."""
    l, m = _offsets(len(weighted), pixel)
    mass = float(weighted.sum())
    if mass == 0:
        return complex(np.nan, np.nan), float("nan")
    q_ll, q_mm, q_lm = (float((weighted * product).sum()) / mass for product in (l**2, m**2, l * m))
    if not (q_ll > 0 and q_ll * q_mm > q_lm**2):
        return complex(np.nan, np.nan), float("nan")
    return ellipticity_of(q_ll, q_lm, q_mm), q_ll + q_mm


def _offsets(size: int, pixel: float) -> tuple[Float[Array, "l 1"], Float[Array, "1 m"]]:
    offset = (np.arange(size) - size // 2) * pixel
    return offset[:, None], offset[None, :]
