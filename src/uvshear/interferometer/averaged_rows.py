"""What rows that are averages over cells of (u, v, w) say of the samples that they are made of."""

import math
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Final, Self

from uvshear.typing import Array, Bool, Float

SECOND: Final = tuple(combinations_with_replacement(range(3), 2))
"""Pairs of coordinates (u, v, w) of the second moments, in their order."""

FOURTH: Final = tuple(combinations_with_replacement(range(3), 4))
"""The same for four coordinates."""


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
    """

    frequency: Float[Array, " row"]
    width: Float[Array, " row"]
    second: Float[Array, "row 6"]
    fourth: Float[Array, "row 15"]

    def select(self, chosen: Bool[Array, " row"] | slice) -> Self:
        """Return the chosen rows."""
        return type(self)(
            self.frequency[chosen], self.width[chosen], self.second[chosen], self.fourth[chosen]
        )
