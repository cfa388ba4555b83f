"""The first pass over an observation: everything that must be known before the first galaxy is fitted."""

from collections.abc import Callable
from dataclasses import dataclass

from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.accumulate import show
from uvshear.interferometer.baseline_map import BaselineMap, BaselineMapAccumulator
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.counted import counted
from uvshear.interferometer.data_warnings import DataQuality, data_warnings
from uvshear.interferometer.noise_sample import MOST, NoiseSample, NoiseSampleAccumulator
from uvshear.interferometer.origin import origin_of, parts_of
from uvshear.interferometer.summary import ObservationSummary, SummaryAccumulator
from uvshear.interferometer.visibilities import Observation

MOST_OF_ALL, FEWEST_OF_A_PART = 2**18, 2**12
"""Number of visibilities that represent the noise of all parts of an observation, which take 50 MB, and the smallest
number for each of many parts, whose noise is then known to 1.1 per cent."""


@dataclass(frozen=True)
class FirstPass:
    """Results of the first pass.

    Parameters
    ----------
    summary
        Size, longest baseline, band and weight of the whole observation.
    baselines
        Weights of the whole observation over the length and the angle of its baselines.
    qualities
        State of the data, part by part.
    noise_samples
        Visibilities from which the noise of each part can be told; None for a part without weight.
    """

    summary: ObservationSummary
    baselines: BaselineMap
    qualities: tuple[DataQuality, ...]
    noise_samples: tuple[NoiseSample | None, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line for each fact about the data that a user should know."""
        return tuple(line for quality in self.qualities for line in data_warnings(quality))


def first_pass(
    observation: Observation,
    executor: Executor = SERIAL,
    on_samples: Callable[[float], None] | None = None,
) -> FirstPass:
    """Read an observation once; ``on_samples`` is called with the number of samples of each chunk.

    Raises
    ------
    InputError
        No visibility carries weight.
    """
    summary, baselines = SummaryAccumulator(), BaselineMapAccumulator()
    qualities, samples = [], []
    parts = parts_of(observation)
    most = min(MOST, max(MOST_OF_ALL // len(parts), FEWEST_OF_A_PART))
    for part in parts:
        counts, sample = SampleCountsAccumulator(), NoiseSampleAccumulator(most)
        chunks = part.chunks() if on_samples is None else counted(part.chunks(), on_samples)
        show(chunks, [summary, baselines, counts, sample], executor)
        qualities.append(DataQuality.from_pass(origin_of(part), counts.result()))
        samples.append(sample.result())
    return FirstPass(summary.result(), baselines.result(), tuple(qualities), tuple(samples))
