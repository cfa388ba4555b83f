"""The content of a file of visibilities, summarised for a user before anything is measured."""

from collections.abc import Iterable
from dataclasses import dataclass

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.accumulate import show
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.data_warnings import DataQuality, data_warnings
from uvshear.interferometer.noise_estimate import NoiseEstimate, estimate_noise
from uvshear.interferometer.noise_sample import NoiseSampleAccumulator
from uvshear.interferometer.noise_warning import noise_warning
from uvshear.interferometer.origin import origin_of
from uvshear.interferometer.ranges import ObservationRanges, RangesAccumulator
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.visibilities import Observation, Visibilities
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Telescope:
    """Array of antennas.

    Parameters
    ----------
    name
        Name of the telescope; empty where it is not given.
    antennas
        Number of antennas.
    diameters
        Distinct diameters of its dishes, where they are given [m].
    """

    name: str
    antennas: int
    diameters: tuple[float, ...]


@dataclass(frozen=True)
class Window:
    """Spectral window.

    Parameters
    ----------
    frequency
        Centres of the channels [Hz].
    width
        Widths of the channels [Hz].
    averaged
        Band that each channel was averaged over [Hz]; 0 where nothing was averaged.
    correlations
        Names of the correlations.
    """

    frequency: Float[Array, " chan"]
    width: Float[Array, " chan"]
    averaged: Float[Array, " chan"]
    correlations: tuple[str, ...]


@dataclass(frozen=True)
class FieldContent:
    """Visibilities of one field.

    Parameters
    ----------
    phase_centre
        Direction of l = m = 0.
    quality
        State of the data: counts of samples, notices.
    ranges
        Ranges of time and of baselines.
    number
        Number of the field; None where the format has none.
    name
        Name of the field.
    weight_column
        Column that the weights come from; empty where the format has none.
    noise
        Noise over the one that the weights imply; None where it is not known, or where the weights do not claim to be
        1/sigma^2.
    uvw_agrees
        Whether UVW, as it is read, is X(ANTENNA1) - X(ANTENNA2) by the antennas' positions; None if neither sign fits,
        or if this was not checked.
    has_averages
        Whether the rows are averages over cells of (u, v, w).
    """

    phase_centre: PhaseCentre
    quality: DataQuality
    ranges: ObservationRanges
    number: int | None = None
    name: str = ""
    weight_column: str = ""
    noise: NoiseEstimate | None = None
    uvw_agrees: bool | None = None
    has_averages: bool = False

    @property
    def counts(self) -> SampleCounts:
        """Numbers of rows and samples; zeros where the reader has not counted."""
        return self.quality.counts or SampleCounts()

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line for each fact about the data that a user should know."""
        of_noise = noise_warning(self.quality.name, self.noise)
        return (*data_warnings(self.quality), *([of_noise] if of_noise else []))


@dataclass(frozen=True)
class Inspection:
    """Content of a file of visibilities.

    Parameters
    ----------
    fields
        Content of each field.
    telescope
        Array that observed; None where the format does not name it.
    columns
        Names of the columns that hold visibilities, in formats that have columns.
    windows
        Spectral windows, where the format has them.
    """

    fields: tuple[FieldContent, ...]
    telescope: Telescope | None = None
    columns: tuple[str, ...] = ()
    windows: tuple[Window, ...] = ()


def inspect_observation(observation: Observation) -> Inspection:
    """Read an observation once for the content that can be found in any format."""
    quality, ranges, noise = examine(observation, observation.chunks())
    return Inspection((FieldContent(observation.phase_centre, quality, ranges, noise=noise),))


def examine(
    observation: Observation, chunks: Iterable[Visibilities]
) -> tuple[DataQuality, ObservationRanges, NoiseEstimate | None]:
    """Return the state of the data, the ranges that they cover, and their noise, from all chunks of an observation."""
    counts, ranges, drawn = SampleCountsAccumulator(), RangesAccumulator(), NoiseSampleAccumulator()
    show(chunks, [counts, ranges, drawn])
    origin, sample = origin_of(observation), drawn.result()
    quality = DataQuality.from_pass(origin, counts.result())
    noise = None
    if sample is not None and origin.weights_tell_noise:
        noise = estimate_noise(sample)
    return quality, ranges.result(), noise
