"""Sub-bands: samples of different sub-bands are not averaged together."""

import math
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.typing import Array, Float, Int

RATIO: Final = 1.1
"""Ratio of the limits of a sub-band. It is the same for all observations, so that their sub-bands agree: an octave
overlaps eight or nine of them."""


@dataclass(frozen=True)
class SubBand:
    """The frequencies from ``RATIO**number`` to ``RATIO**(number + 1)`` [Hz]."""

    number: int

    @classmethod
    def of_channels(cls, frequency: Float[Array, " chan"]) -> list[Self]:
        """Return the sub-bands of some channels [Hz], from the lowest to the highest."""
        return [cls(number) for number in np.unique(_numbers(frequency)).tolist()]

    @property
    def frequency(self) -> float:
        """Frequency in its middle [Hz], at which baselines are given in metres."""
        return RATIO ** (self.number + 0.5)

    @property
    def metres(self) -> float:
        """Wavelength in its middle [m]."""
        return SPEED_OF_LIGHT / self.frequency

    @property
    def highest(self) -> float:
        """Highest frequency over that in its middle."""
        return math.sqrt(RATIO)

    def channels(self, frequency: Float[Array, " chan"]) -> Int[Array, " chosen"]:
        """Return the numbers of the channels that lie in the sub-band."""
        return np.flatnonzero(_numbers(frequency) == self.number)


def _numbers(frequency: Float[Array, " chan"]) -> Int[Array, " chan"]:
    return np.floor(np.log(frequency) / math.log(RATIO)).astype(int)
