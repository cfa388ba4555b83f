"""Samples that cannot be right are left out, and counted by reason."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.array_extent import ArrayExtent
from uvshear.interferometer.averaged_rows import AveragedRows
from uvshear.interferometer.count_samples import SampleCountsAccumulator
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.screening import screened, screened_chunks
from uvshear.interferometer.summary import SummaryAccumulator
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet

ROWS, CHANNELS = 6, 3


def _good():
    rng = np.random.default_rng(1)
    return Visibilities(
        uvw=rng.uniform(100, 1000, (ROWS, 3)),
        frequency=np.linspace(1e9, 1.1e9, CHANNELS),
        stokes_i=rng.normal(size=(ROWS, CHANNELS)).astype(np.complex64),
        weights=np.full((ROWS, CHANNELS), 1e8, np.float32),
        integrations=Integrations(
            np.tile([0, 1], (ROWS, 1)), np.arange(ROWS, dtype=float), np.full(ROWS, 10.0)
        ),
    )


def _with(seen, name, row, value):
    """The same samples with another value in a row of one array."""
    owner = seen.integrations if name in ("time", "interval") else seen
    array = getattr(owner, name).copy()
    array[row] = value
    changed = replace(owner, **{name: array})
    return replace(seen, integrations=changed) if owner is not seen else changed


def test_good_samples_stay_as_they_are():
    good = _good()
    seen = screened(good)
    for name in ("uvw", "stokes_i", "weights"):
        assert getattr(seen, name) is getattr(good, name)
    assert seen.counts == SampleCounts(rows=6, samples=18, usable=18)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("uvw", 0.0, "impossible_uvw"),
        ("uvw", 1e20, "impossible_uvw"),
        ("uvw", np.nan, "impossible_uvw"),
        ("uvw", -np.inf, "impossible_uvw"),
        ("time", np.nan, "impossible_times"),
        ("time", np.inf, "impossible_times"),
        ("interval", np.nan, "impossible_times"),
        ("interval", -1.0, "impossible_times"),
        ("interval", 86401.0, "impossible_times"),
        ("stokes_i", 1e30, "impossible_amplitudes"),
        ("stokes_i", 1e-4 * 1.1e8, "impossible_amplitudes"),
        ("stokes_i", np.nan, "non_finite"),
        ("stokes_i", complex(0, np.inf), "non_finite"),
        ("weights", np.nan, "non_finite"),
        ("weights", np.inf, "non_finite"),
        ("weights", -1.0, "non_positive_weights"),
    ],
)
def test_a_row_that_cannot_be_right_is_left_out_and_counted(name, value, reason):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        seen = screened(_with(_good(), name, 2, value))
    assert not seen.weights[2].any()
    assert (np.delete(seen.weights, 2, axis=0) == 1e8).all()
    assert seen.counts == SampleCounts(rows=6, samples=18, usable=15, **{reason: 3})
    for array in (seen.uvw, seen.stokes_i, seen.weights):
        assert np.isfinite(array).all()
    assert np.isfinite(seen.integrations.time).all()
    assert np.isfinite(seen.integrations.interval).all()
    assert np.abs(seen.uvw).max() < 1e4


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("frequency", np.nan),
        ("frequency", 0.0),
        ("frequency", 0.7e9),
        ("frequency", 1.4e9),
        ("width", -1.0),
        ("width", np.inf),
        ("width", 2e9),
        ("second", np.nan),
        ("second", -2.1 * 100),
        ("fourth", np.inf),
        ("fourth", 1.1 * 1e4),
    ],
)
def test_a_row_that_is_no_average_over_a_cell_is_left_out_and_counted(name, value):
    good = _good()
    rows, size = len(good), np.full(3, 10.0)
    averages = AveragedRows(
        np.full(rows, 1.05e9), np.full(rows, 1e6), np.zeros((rows, 6)), np.zeros((rows, 15)), size
    )
    good = replace(
        good,
        frequency=np.array([1e9]),
        stokes_i=good.stokes_i[:, :1],
        weights=good.weights[:, :1],
        averages=averages,
    )
    assert screened(good).averages is averages
    values = getattr(averages, name).copy()
    values[2, ...] = value
    seen = screened(replace(good, averages=replace(averages, **{name: values})))
    assert np.flatnonzero(seen.weights == 0).tolist() == [2]
    assert seen.counts == SampleCounts(rows=6, samples=6, usable=5, impossible_averages=1)
    assert seen.averages.are_possible(1e9).all()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("frequency", 0.0),
        ("frequency", -1e9),
        ("frequency", np.nan),
        ("frequency", 1e20),
        ("width", -1e6),
        ("width", np.inf),
    ],
)
def test_a_channel_that_cannot_be_right_is_left_out_and_counted(name, value):
    good = replace(_good(), width=np.full(CHANNELS, 1e6))
    values = getattr(good, name).copy()
    values[1] = value
    seen = screened(replace(good, **{name: values}))
    assert seen.counts == SampleCounts(rows=6, samples=18, usable=12, impossible_channels=6)
    np.testing.assert_array_equal(seen.weights > 0, np.tile([True, False, True], (ROWS, 1)))
    assert ((seen.frequency >= 1e9) & (seen.frequency <= 1.1e9)).all()
    assert ((seen.width >= 0) & (seen.width <= 1e6)).all()
    (summary,) = accumulate(VisibilitySet(PhaseCentre(0.0, 0.0), (seen,)), [SummaryAccumulator()])
    assert (summary.lowest_frequency, summary.frequency) == (1e9, 1.1e9)


def test_without_a_channel_nothing_is_left():
    seen = screened(replace(_good(), frequency=np.full(CHANNELS, np.nan)))
    assert seen.counts == SampleCounts(rows=6, samples=18, usable=0, impossible_channels=18)
    assert (seen.frequency > 0).all()


def _many(weights):
    """The good rows again and again, with these weights."""
    good = _good()
    times = len(weights) // (ROWS * CHANNELS)
    return Visibilities(
        np.tile(good.uvw, (times, 1)),
        good.frequency,
        np.tile(good.stokes_i, (times, 1)) * np.complex64(1e-4),
        weights.reshape(-1, CHANNELS).astype(np.float32),
    )


def test_few_weights_that_dwarf_all_others_are_left_out_and_counted():
    weights = np.full(1800, 1e8)
    weights[[7, 500]] = 1.1e14
    weights[600] = 0.9e14
    seen = screened(_many(weights))
    assert seen.counts == SampleCounts(rows=600, samples=1800, usable=1798, impossible_weights=2)
    assert not seen.weights.ravel()[[7, 500]].any()


@pytest.mark.parametrize("part", [0.02, 0.5, 0.9])
def test_weights_that_many_samples_have_stay_however_small_the_others_are(part):
    weights = np.full(1800, 1e-2)
    weights[: int(1800 * part)] = 1e8
    assert screened(_many(weights)).counts.usable == 1800


def test_weights_that_were_changed_after_the_screening_are_not_screened_again():
    seen = screened(_good())
    tapered = seen.weights.copy()
    tapered[1:] = 1e-30
    again = replace(seen, weights=tapered)
    assert screened(again) is again


def test_the_length_of_the_array_limits_the_baselines():
    good = _good()
    second, longest = np.sort(np.linalg.norm(good.uvw, axis=1))[-2:].tolist()
    for limit, expected in ((longest, 0), ((second + longest) / 2, CHANNELS)):
        seen = screened(replace(good, array=ArrayExtent(longest_baseline=limit)))
        assert seen.counts.impossible_uvw == expected


def test_chunks_can_be_read_without_the_samples_that_cannot_be_right():
    observation = VisibilitySet(PhaseCentre(0.0, 0.0), (_with(_good(), "uvw", 0, np.nan), _good()))
    first, second = screened_chunks(observation)
    assert (first.weights[0] == 0).all()
    assert np.isfinite(first.uvw).all()
    assert (second.weights > 0).all()


def test_each_sample_counts_once():
    bad = _good()
    for name, value in (("uvw", 0.0), ("time", np.nan), ("stokes_i", 1e30)):
        bad = _with(bad, name, 4, value)
    assert screened(bad).counts == SampleCounts(rows=6, samples=18, usable=15, impossible_uvw=3)


def test_samples_without_weight_are_nobodys_loss():
    bad = _with(_with(_good(), "weights", 1, 0.0), "uvw", 1, np.nan)
    seen = screened(bad)
    assert seen.counts == SampleCounts(rows=6, samples=18, usable=15, flagged=3)
    assert np.isfinite(seen.uvw).all()


def test_what_a_reader_has_counted_stays():
    known = SampleCounts(rows=6, autocorrelations=2, samples=18, usable=18, flagged=4)
    seen = screened(_with(replace(_good(), counts=known), "uvw", 0, 0.0))
    assert seen.counts == replace(known, usable=15, impossible_uvw=3)


def test_every_pass_is_screened():
    bad = _with(_good(), "uvw", 0, 1e20)
    observation = VisibilitySet(PhaseCentre(0.0, 0.0), (bad, _good()))
    (counts,) = accumulate(observation, [SampleCountsAccumulator()])
    assert counts == SampleCounts(rows=12, samples=36, usable=33, impossible_uvw=3)
