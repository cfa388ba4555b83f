"""How far an observation reaches: what one reading of it tells before anything is measured."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.errors import InputError
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation

PROBES = 4096


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
    probes
        Some thousand of the samples, drawn evenly.
    """

    rows: int
    samples: int
    longest: float
    frequency: float
    lowest_frequency: float
    weight: float
    probes: Samples


def measure_extent(observation: Observation) -> Extent:
    """Read an observation once."""
    rows = samples = 0
    drawn: list[Samples] = []
    lots = np.zeros(0)
    rng = np.random.default_rng(0)
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
            part = Samples.of(chunk, 0.0, math.inf)
            # Those with the lowest lots of all stay: an even draw of a number that nobody knows before.
            lot = rng.random(len(part))
            best = np.argsort(lot)[:PROBES]
            joined, lots = Samples.join([*drawn, part.select(best)]), np.append(lots, lot[best])
            best = np.sort(np.argsort(lots)[:PROBES])
            drawn, lots = [joined.select(best)], lots[best]
    if samples == 0:
        raise InputError("no visibility carries weight: all are flagged, or their weights are zero")
    return Extent(rows, samples, longest, frequency, lowest, weight, drawn[0])
