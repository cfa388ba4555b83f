"""Warnings about facts of the data that do not prevent a measurement; those about noise are in ``noise_warning``."""

from dataclasses import dataclass

from uvshear.interferometer.origin import HasNotices, Origin
from uvshear.interferometer.sample_counts import SampleCounts


@dataclass(frozen=True)
class DataQuality:
    """State of the data of one part of an observation, from one pass over it.

    Parameters
    ----------
    name
        Name of the part, for messages.
    notices
        Facts from the metadata, one sentence each.
    counts
        Numbers of samples that were used and that were left out, by reason; None where the reader has not counted.
    """

    name: str
    notices: tuple[str, ...] = ()
    counts: SampleCounts | None = None

    @classmethod
    def from_pass(cls, origin: Origin, counts: SampleCounts | None) -> "DataQuality":
        """Combine the counts of a pass with the facts from the metadata."""
        source = origin.observation
        notices = source.notices() if isinstance(source, HasNotices) else ()
        return cls(origin.name, notices, counts)


def data_warnings(quality: DataQuality) -> tuple[str, ...]:
    """Return one line for each fact that a user should know: samples left out, odd metadata."""
    name, counts = quality.name, quality.counts or SampleCounts()
    found = [
        f"{name}: {number} of {counts.samples} visibilities {state} without being flagged; they are left out"
        for number, state in (
            (counts.non_finite, "are NaN or infinite, in data or weight,"),
            (counts.non_positive_weights, "have a weight of zero or less"),
            (
                counts.impossible_uvw,
                "have a UVW that is zero, not finite, longer than the array or not as long as the distance between"
                " their antennas,",
            ),
            (
                counts.impossible_times,
                "have a time or integration time that is negative, NaN, infinite or longer than a day",
            ),
            (
                counts.impossible_channels,
                "have a frequency or a channel width that no radio telescope has",
            ),
            (
                counts.impossible_averages,
                "have a frequency, a width or moments that no average over a cell has",
            ),
            (counts.impossible_weights, "have more than a million times the weight of the others"),
            (counts.impossible_amplitudes, "are more than 1e8 times their noise"),
        )
        if number
    ]
    if rows := counts.autocorrelations_with_uvw:
        found.append(
            f"{name}: the number of rows with two equal antennas but a UVW that is not zero is {rows}; they are left"
            " out as autocorrelations"
        )
    return (*found, *(f"{name}: {notice}" for notice in quality.notices))
