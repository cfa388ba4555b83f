"""Rows of correlations combined to Stokes I."""

from pathlib import Path

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.visibilities import Integrations
from uvshear.io.correlated_rows import CorrelatedRows, check_usable, hands_slice

FREQUENCY, AVERAGED = np.array([1e9, 2e9]), np.array([1e6, 0.0])


def rows(antennas):
    count = len(antennas)
    data = np.arange(count * 4).reshape(count, 2, 2) * (1 + 1j)
    return CorrelatedRows(
        uvw=np.arange(3.0 * count).reshape(count, 3),
        integrations=Integrations(np.array(antennas), np.arange(count) * 1.0, np.ones(count)),
        correlations=data.astype("c8"),
        weights=np.full((count, 2, 2), 4.0, "f4"),
        flags=np.zeros((count, 2, 2), bool),
    )


def test_the_mean_of_two_hands_has_the_weight_of_both():
    seen = rows([(0, 1), (0, 2)]).combine(FREQUENCY, AVERAGED)
    np.testing.assert_allclose(seen.stokes_i, [[0.5 + 0.5j, 2.5 + 2.5j], [4.5 + 4.5j, 6.5 + 6.5j]])
    np.testing.assert_array_equal(seen.weights, 8.0)
    assert seen.width is AVERAGED
    assert seen.counts == SampleCounts(rows=2, samples=4, usable=4)


def test_autocorrelations_are_counted_and_left_out():
    found = rows([(0, 1), (1, 1), (1, 2)])
    found.flags[1:, 0, 1] = True
    found.correlations[0, 1] = np.nan
    found.uvw[1] = 0.0
    seen = found.combine(FREQUENCY, AVERAGED)
    assert seen.integrations.antennas.tolist() == [[0, 1], [1, 2]]
    np.testing.assert_array_equal(seen.uvw, found.uvw[[0, 2]])
    np.testing.assert_array_equal(seen.weights, [[8, 0], [0, 8]])
    expected = SampleCounts(
        rows=2, autocorrelations=1, samples=4, usable=2, flagged=1, non_finite=1
    )
    assert seen.counts == expected


def test_autocorrelations_that_have_a_baseline_are_counted():
    found = rows([(0, 1), (1, 1), (2, 2), (3, 3), (4, 4)])
    found.uvw[1:] = [[0, 0, 0], [30, 40, 0], [0, 0, 0.5], [np.nan, 0, 0]]
    counts = found.combine(FREQUENCY, AVERAGED).counts
    assert (counts.autocorrelations, counts.autocorrelations_with_uvw) == (4, 1)


@pytest.mark.parametrize(
    ("hands", "taken"), [((0,), [0]), ((3,), [3]), ((0, 3), [0, 3]), ((1, 0), [0, 1])]
)
def test_hands_are_taken_with_a_slice(hands, taken):
    assert list(range(4))[hands_slice(hands)] == taken


@pytest.mark.parametrize(
    ("counts", "scans", "message"),
    [
        (
            SampleCounts(),
            None,
            "there are no rows in the field; baselines between antennas are needed",
        ),
        (SampleCounts(), (3, 4), "there are no rows in scans 3, 4 of the field"),
        (SampleCounts(autocorrelations=2), None, "there are only autocorrelations in the field"),
        (SampleCounts(rows=1, samples=2, flagged=2), None, "all visibilities are flagged"),
        (
            SampleCounts(rows=1, samples=2, non_finite=1, non_positive_weights=1),
            None,
            "no visibility is usable: of 2 visibilities, 0 are flagged, 1 not finite, 1 without",
        ),
    ],
)
def test_what_cannot_be_used_is_refused_with_the_reason(counts, scans, message):
    with pytest.raises(InputError, match=f"^a.ms: {message}"):
        check_usable(Path("a.ms"), counts, scans)


def test_one_usable_sample_is_enough():
    check_usable(Path("a.ms"), SampleCounts(rows=1, samples=2, usable=1), None)
