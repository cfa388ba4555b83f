"""Ranges of time, of integration and of baseline that an observation covers."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.interferometer.accumulate import Accumulator
from uvshear.interferometer.screening import NO_TIME
from uvshear.interferometer.visibilities import Visibilities
from uvshear.typing import Array, Float

Range = tuple[float, float]
"""Lowest and highest value; (inf, -inf) where there is none."""


@dataclass(frozen=True)
class ObservationRanges:
    """Lowest and highest values of an observation.

    Parameters
    ----------
    time
        Start of the first and end of the last integration, UTC [MJD s].
    interval
        Shortest and longest integration [s].
    baseline
        Shortest and longest projected baseline with weight [m].
    uv_distance
        Shortest and longest projected baseline with weight [wavelengths].
    """

    time: Range
    interval: Range
    baseline: Range
    uv_distance: Range


class RangesAccumulator(Accumulator[ObservationRanges]):
    """Gathers :class:`ObservationRanges`."""

    def __init__(self) -> None:
        names = ObservationRanges.__dataclass_fields__
        self._ranges: dict[str, Range] = dict.fromkeys(names, (math.inf, -math.inf))

    def add(self, seen: Visibilities) -> None:
        """Take in the next chunk."""
        if not len(seen):
            return
        taken = seen.integrations
        if taken is not None:
            is_known = taken.time != NO_TIME
            if is_known.any():
                time, half = taken.time[is_known], taken.interval[is_known] / 2
                self._widen("time", _ends(np.stack([time - half, time + half])))
            if (is_known := is_known | (taken.interval > 0)).any():
                self._widen("interval", _ends(taken.interval[is_known]))
        if (used := seen.weights > 0).any():
            per_metre = seen.frequency / SPEED_OF_LIGHT
            self._widen("uv_distance", _ends(seen.uv_distance[used]))
            self._widen("baseline", _ends((seen.uv_distance / per_metre)[used]))

    def merge(self, later: Self) -> None:
        """Take in the ranges of later visibilities."""
        for name, ends in later._ranges.items():
            self._widen(name, ends)

    def result(self) -> ObservationRanges:
        """Return the ranges."""
        return ObservationRanges(**self._ranges)

    def _widen(self, name: str, ends: Range) -> None:
        low, high = self._ranges[name]
        self._ranges[name] = min(low, ends[0]), max(high, ends[1])


def _ends(values: Float[Array, "..."]) -> Range:
    return float(values.min()), float(values.max())
