"""What rows that are averages over cells of (u, v, w) say of the samples that they are made of."""

import math
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Final, Self

import numpy as np

from uvshear.typing import Array, Bool, Float

SECOND: Final = tuple(combinations_with_replacement(range(3), 2))
"""Pairs of coordinates (u, v, w) of the second moments, in their order."""

FOURTH: Final = tuple(combinations_with_replacement(range(3), 4))
"""The same for four coordinates."""


LARGEST_SECOND, LARGEST_FOURTH = 2.0, 1.0
"""Moduli of the coefficients, for cells of size 1, beyond which samples cannot lie in one cell. Those of 4 million rows
of MeerKAT are at most 0.5 and 0.06."""

MOST_OFF = 1.25
"""Ratio of a row's frequency to that of its sub-band which no row reaches: a sub-band spans a factor of 1.1."""


def permutations_of(place: tuple[int, ...]) -> int:
    """Return the number of different orders of some coordinates: how often a symmetric coefficient counts."""
    same = math.prod(math.factorial(place.count(axis)) for axis in set(place))
    return math.factorial(len(place)) // same


@dataclass(frozen=True)
class AveragedRows:
    """Weighted means and moments over the samples of each row, which has one channel.

    A source with the phase phi = 2 pi (u l + v m + w (n - 1)) loses the factor exp(-C/2 - Q/2), where C and Q are the
    forms of second and fourth degree with these coefficients, of 2 pi (l, m, n - 1).

    Parameters
    ----------
    frequency
        Mean frequency of the samples, with the weights of the row's node [Hz].
    width
        Mean of Δν/ν of the samples, where Δν is the width of a channel, times this frequency [Hz].
    second
        Second moments of the samples' baselines about that of the row (``SECOND``), with the weights of its node and in
        the unit of its UVW [m^2].
    fourth
        Symmetric coefficients of what is lost beyond them (``FOURTH``) [m^4].
    size
        Sizes of the cells along u, v and w [m].
    """

    frequency: Float[Array, " row"]
    width: Float[Array, " row"]
    second: Float[Array, "row 6"]
    fourth: Float[Array, "row 15"]
    size: Float[Array, " 3"]

    def select(self, chosen: Bool[Array, " row"] | slice) -> Self:
        """Return the chosen rows."""
        return type(self)(
            self.frequency[chosen],
            self.width[chosen],
            self.second[chosen],
            self.fourth[chosen],
            self.size,
        )

    def are_possible(self, frequency: float) -> Bool[Array, " row"]:
        """Tell which rows can be averages over a cell in the sub-band at this frequency [Hz]."""
        with np.errstate(invalid="ignore", divide="ignore"):
            off = np.maximum(self.frequency / frequency, frequency / self.frequency)
            is_possible = (off > 0) & (off < MOST_OFF)
            is_possible &= (self.width >= 0) & (self.width < self.frequency)
            for found, places, largest in (
                (self.second, SECOND, LARGEST_SECOND),
                (self.fourth, FOURTH, LARGEST_FOURTH),
            ):
                limits = largest * self.size[np.array(places)].prod(axis=1)
                is_possible &= (np.abs(found) <= limits).all(axis=1)
        return is_possible

    def with_harmless(self, wrong: Bool[Array, " row"], frequency: float) -> Self:
        """Return the rows; those that are wrong become single samples at this frequency [Hz]."""
        return type(self)(
            np.where(wrong, frequency, self.frequency),
            np.where(wrong, 0.0, self.width),
            np.where(wrong[:, None], 0.0, self.second),
            np.where(wrong[:, None], 0.0, self.fourth),
            self.size,
        )
