"""Ranges of an observation."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.interferometer.chunks import CENTRE, chunk, observation, without_weight
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.ranges import RangesAccumulator
from uvshear.interferometer.visibilities import VisibilitySet

NOTHING = (math.inf, -math.inf)


def _ranges(*blocks):
    return accumulate(VisibilitySet(CENTRE, blocks), [RangesAccumulator()])[0]


def test_ranges_are_over_all_chunks():
    (ranges,) = accumulate(observation(1, 2), [RangesAccumulator()])
    assert ranges.interval == (9.0, 10.0)
    assert ranges.time == pytest.approx((100 - 4.5, 200 + 88 + 5))
    used = np.concatenate([block.uv_distance[block.weights > 0] for block in (chunk(1), chunk(2))])
    assert ranges.uv_distance == (used.min(), used.max())


def test_baselines_without_weight_do_not_count():
    ranges = _ranges(without_weight(chunk(1)))
    assert ranges.baseline == ranges.uv_distance == NOTHING
    assert ranges.interval == (9.0, 9.0)


def test_rows_of_unknown_integrations_have_baselines_only():
    ranges = _ranges(replace(chunk(1), integrations=None))
    assert ranges.time == ranges.interval == NOTHING
    assert ranges.baseline[1] > 0


def test_times_that_cannot_be_right_do_not_count():
    block = chunk(1)
    expected = _ranges(block)
    wrong = np.where(np.arange(len(block)) == 3, np.nan, block.integrations.time)
    assert _ranges(replace(block, integrations=replace(block.integrations, time=wrong))) == expected
    none = replace(block.integrations, time=np.full(len(block), np.nan))
    assert _ranges(replace(block, integrations=none)).time == NOTHING


def test_there_may_be_nothing():
    assert _ranges().time == NOTHING
