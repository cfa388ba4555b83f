"""How far an observation reaches: what one reading of it tells before anything is measured."""

from dataclasses import dataclass

from uvshear.errors import InputError
from uvshear.interferometer.visibilities import Observation


@dataclass(frozen=True)
class Extent:
    """What there is.

    Parameters
    ----------
    rows
        Number of rows.
    samples
        Visibilities that carry weight.
    longest
        Longest baseline with weight [wavelengths].
    frequency
        The highest [Hz].
    lowest_frequency
        The lowest [Hz].
    weight
        Sum of the weights [Jy^-2]: 1/weight is the variance of a point source's flux.
    """

    rows: int
    samples: int
    longest: float
    frequency: float
    lowest_frequency: float
    weight: float


def measure_extent(observation: Observation) -> Extent:
    """Read an observation once."""
    rows = samples = 0
    longest = weight = frequency = 0.0
    lowest = float("inf")
    for chunk in observation.chunks():
        used = chunk.weights > 0
        rows += len(chunk)
        samples += int(used.sum())
        frequency = max(frequency, float(chunk.frequency.max()))
        lowest = min(lowest, float(chunk.frequency.min()))
        weight += float(chunk.weights.sum(dtype=float))
        if used.any():
            longest = max(longest, float(chunk.uv_distance[used].max()))
    if samples == 0:
        raise InputError("no visibility carries weight: all are flagged, or their weights are zero")
    return Extent(rows, samples, longest, frequency, lowest, weight)
