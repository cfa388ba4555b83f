"""Warnings about data that are measured all the same."""

from dataclasses import dataclass
from typing import Final

from uvshear.interferometer.origin import HasNotices, Origin
from uvshear.interferometer.sample_counts import SampleCounts

WEIGHTS_OFF: Final = 0.2
"""Fraction by which the noise may differ from what the weights claim before it is worth a warning."""


@dataclass(frozen=True)
class DataQuality:
    """What one pass over a part of an observation tells of its data.

    Parameters
    ----------
    name
        Name of the part, for messages.
    notices
        Sentences from the metadata alone.
    counts
        Numbers of samples by whether and why they were left out; None where nobody has counted.
    noise_ratio
        Standard deviation of the noise over the one that the weights claim; None where it is not known, or where
        the weights make no claim.
    """

    name: str
    notices: tuple[str, ...] = ()
    counts: SampleCounts | None = None
    noise_ratio: float | None = None

    @classmethod
    def from_pass(
        cls, origin: Origin, counts: SampleCounts | None, noise_ratio: float | None
    ) -> "DataQuality":
        """Put together what a pass has gathered and what the metadata tell."""
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
        )
        if number
    ]
    found += [f"{name}: {notice}" for notice in quality.notices]
    if ratio is not None and abs(ratio - 1) > WEIGHTS_OFF:
        found.append(
            f"{name}: the noise is {ratio:.3g} times what the weights claim, judged by the scatter of neighbouring"
            " samples; all errors are wrong by this factor unless the weights are corrected or measured from the data"
            " (--noise data)"
        )
    return tuple(found)
