"""Totals of counts."""

from dataclasses import replace

from tests.interferometer.chunks import CENTRE, chunk, observation
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.visibilities import VisibilitySet


def test_totals_are_over_all_chunks():
    (total,) = accumulate(observation(1, 2), [SampleCountsAccumulator()])
    assert total == chunk(1).counts + chunk(2).counts


def test_there_is_no_total_where_nobody_has_counted():
    data = VisibilitySet(CENTRE, (replace(chunk(1), counts=None),))
    assert accumulate(data, [SampleCountsAccumulator()]) == (None,)
