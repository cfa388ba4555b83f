"""Numbers of samples that were read, and of those that are left out, by reason."""

from dataclasses import dataclass, fields
from typing import Self


@dataclass(frozen=True)
class SampleCounts:
    """Numbers of rows and samples, as a reader counted them.

    Parameters
    ----------
    rows
        Rows with two different antennas.
    autocorrelations
        Rows left out because both antennas are the same.
    autocorrelations_with_uvw
        Those of them whose UVW is not that of one antenna, so that ANTENNA1 or ANTENNA2 may be wrong.
    samples
        Samples of Stokes I: rows times channels.
    usable
        Samples with a positive weight.
    flagged
        Samples that are flagged in one of the correlations or by the flag of the row.
    non_finite
        Samples without a flag that have a NaN or an infinity in data or weight.
    non_positive_weights
        Finite samples without a flag whose weight is zero or negative.
    impossible_uvw
        Samples with weight whose UVW is not finite, is zero, is longer than any baseline of the array, or is not as
        long as the distance between their antennas.
    impossible_times
        Other samples with weight whose time is not finite, or whose integration is negative or longer than a day.
    impossible_channels
        Other samples with weight whose frequency or channel width cannot be that of a radio telescope.
    impossible_averages
        Other samples with weight that cannot be averages over a cell of (u, v, w), as the set says that they are.
    impossible_weights
        Other samples whose weight is more than a million times that of nearly all others.
    impossible_amplitudes
        Other samples with weight whose signal-to-noise ratio is larger than any.
    """

    rows: int = 0
    autocorrelations: int = 0
    autocorrelations_with_uvw: int = 0
    samples: int = 0
    usable: int = 0
    flagged: int = 0
    non_finite: int = 0
    non_positive_weights: int = 0
    impossible_uvw: int = 0
    impossible_times: int = 0
    impossible_channels: int = 0
    impossible_averages: int = 0
    impossible_weights: int = 0
    impossible_amplitudes: int = 0

    @property
    def flagged_fraction(self) -> float:
        """Fraction of the samples that is flagged."""
        return self.flagged / self.samples if self.samples else 0.0

    def __add__(self, other: Self) -> Self:
        """Add the numbers."""
        return type(self)(
            *(getattr(self, name.name) + getattr(other, name.name) for name in fields(self))
        )
