"""Totals of counts."""

from dataclasses import replace

import numpy as np

from tests.interferometer.chunks import CENTRE, chunk, observation
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.visibilities import VisibilitySet


def test_totals_are_over_all_chunks():
    (total,) = accumulate(observation(1, 2), [SampleCountsAccumulator()])
    assert total == chunk(1).counts + chunk(2).counts


def test_a_pass_counts_what_a_reader_has_not_counted():
    seen = replace(chunk(1), counts=None)
    (total,) = accumulate(VisibilitySet(CENTRE, (seen,)), [SampleCountsAccumulator()])
    assert (total.rows, total.samples) == (len(seen), seen.weights.size)
    assert total.usable == np.count_nonzero(seen.weights)


def test_there_is_no_total_of_nothing():
    assert SampleCountsAccumulator().result() is None
