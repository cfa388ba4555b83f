"""What rows that are averages over cells of (u, v, w) say of the samples that they are made of."""

from dataclasses import dataclass
from typing import Final, Self

from uvshear.typing import Array, Bool, Float

MOMENTS: Final = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""Pairs of coordinates (u, v, w) of the second moments, in their order."""


@dataclass(frozen=True)
class AveragedRows:
    """Weighted means and second moments over the samples of each row, which has one channel.

    Parameters
    ----------
    frequency
        Mean frequency of the samples [Hz].
    width
        Mean of Δν/ν of the samples, where Δν is the width of a channel, times the mean frequency [Hz].
    covariance
        Second moments of the samples' baselines about their mean (``MOMENTS``), in the unit of the rows' UVW [m^2].
    """

    frequency: Float[Array, " row"]
    width: Float[Array, " row"]
    covariance: Float[Array, "row 6"]

    def select(self, chosen: Bool[Array, " row"] | slice) -> Self:
        """Return the chosen rows."""
        return type(self)(self.frequency[chosen], self.width[chosen], self.covariance[chosen])
