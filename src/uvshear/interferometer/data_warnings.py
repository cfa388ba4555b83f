"""Warnings about facts of the data that do not prevent a measurement."""

from dataclasses import dataclass
from typing import Final

from uvshear.interferometer.origin import HasNotices, Origin
from uvshear.interferometer.sample_counts import SampleCounts

WEIGHTS_OFF: Final = 0.2
"""Fraction by which the noise may differ from the noise that the weights imply without a warning."""


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
    noise_ratio
        Standard deviation of the noise over the one that the weights imply; None where it is not known, or where the
        weights do not claim to be 1/sigma^2.
    """

    name: str
    notices: tuple[str, ...] = ()
    counts: SampleCounts | None = None
    noise_ratio: float | None = None

    @classmethod
    def from_pass(
        cls, origin: Origin, counts: SampleCounts | None, noise_ratio: float | None
    ) -> "DataQuality":
        """Combine the results of a pass with the facts from the metadata."""
        source = origin.observation
        notices = source.notices() if isinstance(source, HasNotices) else ()
        known = noise_ratio if origin.weights_tell_noise else None
        return cls(origin.name, notices, counts, known)


def data_warnings(quality: DataQuality) -> tuple[str, ...]:
    """Return one line for each fact that a user should know: samples left out, wrong weights, odd metadata."""
    name, counts, ratio = quality.name, quality.counts or SampleCounts(), quality.noise_ratio
    found = [
        f"{name}: {number} of {counts.samples} visibilities {state} without being flagged; they are left out"
        for number, state in (
            (counts.non_finite, "are NaN or infinite, in data or weight,"),
            (counts.non_positive_weights, "have a weight of zero or less"),
            (
                counts.impossible_uvw,
                "have a UVW that is zero, not finite or longer than the array,",
            ),
            (
                counts.impossible_times,
                "have a time or integration that is negative, NaN or infinite",
            ),
            (
                counts.impossible_channels,
                "have a frequency or a channel width that no radio telescope has",
            ),
            (counts.impossible_weights, "have more than a million times the weight of the others"),
            (counts.impossible_amplitudes, "are more than 1e8 times their noise"),
        )
        if number
    ]
    found += [f"{name}: {notice}" for notice in quality.notices]
    if ratio is not None and abs(ratio - 1) > WEIGHTS_OFF:
        found.append(
            f"{name}: the noise is {ratio:.3g} times what the weights claim, judging by the scatter of neighbouring"
            " samples; all errors are wrong by this factor unless the weights are corrected, or the noise is taken from"
            " the data (--noise data, or uvshear.scaled_to_its_noise in Python)"
        )
    return tuple(found)
