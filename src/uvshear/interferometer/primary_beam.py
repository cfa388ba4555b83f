r"""Primary beams: the response of a dish as a function of the distance from its pointing direction.

A visibility contains the product of the voltage beams of its two antennas, which for equal dishes is the power beam.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.special import j1

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.geometry.directions import n_minus_one, n_minus_one_at
from uvshear.interferometer.attenuation import AttenuatedSamples, PreparedAttenuation
from uvshear.interferometer.kernels import multiply_by_entries
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float, Int

MEERKAT_WIDTH = math.radians(57.5 / 60) * 1.5e9
"""Full width at half maximum of a MeerKAT dish's power beam, times the frequency [rad Hz]."""

LARGEST_DISH = 1e4
"""Diameter that no dish has [m]."""

_UNIFORM_WIDTH = 1.028993969962188
"""Full width at half maximum of the power beam of a uniformly illuminated disc, over wavelength/diameter: (2 J1(x)/x)^2
is 1/2 at x = 1.616."""

_COSINE_WIDTH = 1.18896
"""Argument of the cosine taper's beam, in full widths at half maximum."""


@dataclass(frozen=True)
class PrimaryBeam(PreparedAttenuation):
    """Beams of dishes that all point in the same direction, with one width for each antenna.

    Parameters
    ----------
    width
        Full width at half maximum of each antenna's power beam, times the frequency [rad Hz]; a single number if all
        dishes are alike.
    pointing
        Direction cosines (l, m) of the dishes' axis, which are not (0, 0) if the phase centre was changed after the
        observation.
    """

    width: Float[Array, " antenna"]
    pointing: tuple[float, float] = (0.0, 0.0)

    @abstractmethod
    def voltage(self, x: Float[Array, "..."]) -> Float[Array, "..."]:
        """Voltage beam at a distance from the axis, in full widths at half maximum of the power beam."""

    def over(self, samples: Samples) -> AttenuatedSamples:
        """Return the product of both antennas' voltage beams at these samples, for many sources.

        Raises
        ------
        InputError
            The dishes differ, and the samples have antennas without a width.
        """
        widths, kind = np.unique(self.width, return_inverse=True)
        if len(widths) == 1:
            pair = np.zeros(len(samples), np.int32)
        else:
            self._check_antennas(samples)
            first, second = kind[samples.antennas.T]
            pair = (first * len(widths) + second).astype(np.int32)
        return _Dishes(self, widths, pair, samples.frequency)

    def distance(
        self, l: Float[Array, " source"], m: Float[Array, " source"]
    ) -> Float[Array, " source"]:
        """Distance of directions from the dishes' axis [rad]."""
        l0, m0 = self.pointing
        with np.errstate(invalid="ignore"):  # beyond the horizon
            n = n_minus_one(l, m)
        square = (l - l0) ** 2 + (m - m0) ** 2 + (n - n_minus_one_at(l0, m0)) ** 2
        return 2 * np.arcsin(np.minimum(np.sqrt(square) / 2, 1.0))

    def _check_antennas(self, samples: Samples) -> None:
        known, seen = len(self.width), samples.antennas
        if len(samples) and not 0 <= seen.min() <= seen.max() < known:
            raise InputError(
                f"the primary beam has widths for antennas 0 to {known - 1}, but the data contain other antennas"
            )


class _Dishes(AttenuatedSamples):
    """Primary beams of the two dishes of each sample.

    Parameters
    ----------
    beam
        Beams of the dishes.
    widths
        Widths of the kinds of dishes, times the frequency [rad Hz].
    pair
        Number of the first dish's kind, times the number of kinds, plus that of the second.
    frequency
        Frequency of each sample [Hz].
    """

    def __init__(
        self,
        beam: PrimaryBeam,
        widths: Float[Array, " kind"],
        pair: Int[Array, " sample"],
        frequency: Float[Array, " sample"],
    ) -> None:
        self._beam, self._widths, self._pair, self._frequency = beam, widths, pair, frequency
        # The samples of one channel share a few values.
        self._is_one_channel = len(frequency) > 0 and frequency.min() == frequency.max()

    def multiply(
        self,
        factors: Float[Array, "source sample"],
        l: Float[Array, " source"],
        m: Float[Array, " source"],
    ) -> None:
        voltage, widths = self._beam.voltage, self._widths
        distance = self._beam.distance(l, m)[:, None]
        if self._is_one_channel:
            of_kind = voltage(distance * self._frequency[0] / widths)
            tables = (of_kind[:, :, None] * of_kind[:, None, :]).reshape(len(factors), -1)
            multiply_by_entries(tables.astype(factors.dtype), self._pair, factors)
            return
        for factor, scaled in zip(factors, distance * self._frequency, strict=True):
            if len(widths) == 1:
                factor[:] *= voltage(scaled / widths[0]) ** 2
                continue
            for number in np.divmod(self._pair, len(widths)):
                factor[:] *= voltage(scaled / widths[number])


@dataclass(frozen=True)
class AiryBeam(PrimaryBeam):
    """Beam of uniformly illuminated discs."""

    @classmethod
    def from_diameters(
        cls, diameters: Float[Array, " antenna"], pointing: tuple[float, float] = (0.0, 0.0)
    ) -> Self:
        """Return the beam of dishes of these diameters [m], all of which must be known (positive)."""
        return cls(_width_of_disc(diameters), pointing)

    def voltage(self, x: Float[Array, "..."]) -> Float[Array, "..."]:
        """2 J1(y)/y, y = pi D/lambda times the distance."""
        y = np.maximum(math.pi * _UNIFORM_WIDTH * np.abs(x), 1e-8)
        return 2 * j1(y) / y


@dataclass(frozen=True)
class CosineCubedBeam(PrimaryBeam):
    """Power beam cos^3, zero beyond its first zero: an approximation to the main lobe of tapered dishes."""

    @classmethod
    def from_diameters(
        cls, diameters: Float[Array, " antenna"], pointing: tuple[float, float] = (0.0, 0.0)
    ) -> Self:
        """Return the beam as wide as that of uniformly illuminated discs of these diameters [m], all of them known."""
        return cls(_width_of_disc(diameters), pointing)

    def voltage(self, x: Float[Array, "..."]) -> Float[Array, "..."]:
        """cos^(3/2), 1/sqrt 2 at half the width."""
        half = 2 * math.acos(0.5 ** (1 / 3))
        return np.maximum(np.cos(np.minimum(half * np.abs(x), math.pi / 2)), 0.0) ** 1.5


@dataclass(frozen=True)
class CosineTaperBeam(PrimaryBeam):
    """Beam of dishes with a cosine-tapered field, as MeerKAT's in Stokes I (Mauch et al. 2020, ApJ 888, 61)."""

    @classmethod
    def meerkat(cls, pointing: tuple[float, float] = (0.0, 0.0)) -> Self:
        """Return the beam of MeerKAT's dishes, which are all alike: 57.5 arcmin at 1.5 GHz."""
        return cls(np.array([MEERKAT_WIDTH]), pointing)

    def voltage(self, x: Float[Array, "..."]) -> Float[Array, "..."]:
        """cos(1.189 pi x)/(1 - 4 (1.189 x)^2)."""
        y = _COSINE_WIDTH * np.asarray(x, float)
        near = np.abs(np.abs(y) - 0.5) < 1e-6
        safe = np.where(near, 0.0, y)
        return np.where(near, math.pi / 4, np.cos(math.pi * safe) / (1 - 4 * safe**2))


def _width_of_disc(diameters: Float[Array, " antenna"]) -> Float[Array, " antenna"]:
    unknown = ~((np.asarray(diameters) > 0) & (np.asarray(diameters) < LARGEST_DISH))
    if np.any(unknown):
        raise InputError(
            f"the diameter of the dish of antenna {int(np.argmax(unknown))} is not known, and this primary beam"
            " needs it; fill in DISH_DIAMETER of the ANTENNA table (or the file of the layout), or measure without"
            " a primary beam"
        )
    return _UNIFORM_WIDTH * SPEED_OF_LIGHT / diameters
