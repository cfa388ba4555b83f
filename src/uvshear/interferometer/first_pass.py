"""The first pass over an observation: everything that must be known before the first galaxy is fitted."""

from dataclasses import dataclass

from uvshear.execution import SERIAL, Executor
from uvshear.interferometer.accumulate import show
from uvshear.interferometer.baseline_map import BaselineMap, BaselineMapAccumulator
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.data_warnings import DataQuality, data_warnings
from uvshear.interferometer.noise_estimate import NoiseRatioAccumulator
from uvshear.interferometer.origin import origin_of, parts_of
from uvshear.interferometer.summary import ObservationSummary, SummaryAccumulator
from uvshear.interferometer.visibilities import Observation


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
    """

    summary: ObservationSummary
    baselines: BaselineMap
    qualities: tuple[DataQuality, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line for each fact about the data that a user should know."""
        return tuple(line for quality in self.qualities for line in data_warnings(quality))


def first_pass(observation: Observation, executor: Executor = SERIAL) -> FirstPass:
    """Read an observation once.

    Weights that were scaled to the noise of the data or changed by another weighting are not compared with the noise.

    Raises
    ------
    InputError
        No visibility carries weight.
    """
    summary, baselines = SummaryAccumulator(), BaselineMapAccumulator()
    qualities = []
    for part in parts_of(observation):
        origin, counts, noise = origin_of(part), SampleCountsAccumulator(), NoiseRatioAccumulator()
        compared = [noise] if origin.weights_tell_noise else []
        show(part.chunks(), [summary, baselines, counts, *compared], executor)
        qualities.append(DataQuality.from_pass(origin, counts.result(), noise.result()))
    return FirstPass(summary.result(), baselines.result(), tuple(qualities))
