"""Visibilities that are drawn with their neighbours."""

from dataclasses import replace

import numpy as np
import pytest

from tests.interferometer.chunks import BASELINES, chunk, observation
from uvshear.interferometer.accumulate import accumulate, show
from uvshear.interferometer.noise_sample import NoiseSampleAccumulator
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Integrations, VisibilitySet


def sampled(*blocks, most=2**14):
    accumulator = NoiseSampleAccumulator(most)
    show(blocks, [accumulator])
    return accumulator.result()


def labelled(integrations=12, channels=4):
    """A chunk whose visibilities are the numbers of the baseline, the integration and the channel."""
    seen = chunk(1, integrations=integrations, channels=channels)
    baseline = np.tile(np.arange(BASELINES), integrations)[:, None]
    time = np.repeat(np.arange(integrations), BASELINES)[:, None]
    labels = baseline + 100 * time + 10_000j * (1 + np.arange(channels))
    return replace(seen, stokes_i=labels, weights=np.ones(labels.shape))


@pytest.mark.parametrize("order", ["as it is", "shuffled"])
def test_neighbours_are_the_next_integration_and_a_channel_beside(order):
    seen = labelled()
    if order == "shuffled":
        taken = seen.integrations
        rows = np.random.default_rng(1).permutation(len(seen))
        seen = replace(
            seen,
            uvw=seen.uvw[rows],
            stokes_i=seen.stokes_i[rows],
            weights=seen.weights[rows],
            integrations=Integrations(taken.antennas[rows], taken.time[rows], taken.interval[rows]),
        )
    sample = sampled(seen)
    assert len(sample.here) == seen.weights.size
    has_next = sample.later.weights > 0
    assert np.count_nonzero(has_next) == 11 * BASELINES * 4
    step = (sample.later.stokes_i - sample.here.stokes_i)[has_next]
    np.testing.assert_array_equal(step, 100)
    beside = (sample.beside.stokes_i - sample.here.stokes_i) / 10_000j
    assert np.all(sample.beside.weights > 0)
    assert set(np.unique(beside.real)) == {-1.0, 1.0}
    # A neighbour has the baseline of its own row and channel.
    same = sample.beside.uvw / sample.beside.frequency[:, None]
    np.testing.assert_allclose(same, sample.here.uvw / sample.here.frequency[:, None])


def test_across_a_gap_there_is_no_next_integration():
    seen = labelled(integrations=4, channels=1)
    taken = seen.integrations
    later = np.where(taken.time > taken.time.min() + 10, taken.time + 600, taken.time)
    sample = sampled(replace(seen, integrations=replace(taken, time=later)))
    assert np.count_nonzero(sample.later.weights) == 2 * BASELINES


def test_without_integrations_or_channels_there_are_no_neighbours():
    sample = sampled(replace(labelled(channels=1), integrations=None))
    assert not sample.later.weights.any()
    assert not sample.beside.weights.any()


def test_samples_without_weight_are_neither_drawn_nor_neighbours():
    seen = labelled()
    weights = seen.weights.copy()
    weights[:, 1] = 0
    sample = sampled(replace(seen, weights=weights))
    assert len(sample.here) == 3 * len(seen)
    of_first = sample.here.stokes_i.imag == 10_000
    assert not sample.beside.weights[of_first].any()


def test_the_number_of_visibilities_is_limited():
    sample = sampled(labelled(integrations=50), labelled(integrations=50), most=500)
    assert len(sample.here) == len(sample.later) == len(sample.beside) == 500
    assert len(sample.at_most(100).here) == 100


def test_a_range_of_baselines_is_selected_with_its_neighbours():
    sample = sampled(labelled())
    middle = float(np.median(sample.here.uv_distance))
    within = sample.within(UvRange(middle))
    assert len(within.here) == len(within.later) == pytest.approx(len(sample.here) / 2, abs=5)
    assert within.here.uv_distance.min() >= middle


def test_powers_of_hands_are_gathered():
    seen = replace(labelled(), hand_powers=np.arange(5.0))
    np.testing.assert_array_equal(sampled(seen, seen).hand_powers, np.tile(np.arange(5.0), 2))
    assert len(sampled(labelled()).hand_powers) == 0


def test_an_observation_without_weight_has_no_sample():
    assert sampled() is None
    seen = labelled()
    assert sampled(replace(seen, weights=0 * seen.weights)) is None


def test_a_pass_for_the_noise_alone_ends_when_there_is_enough(monkeypatch):
    monkeypatch.setattr("uvshear.interferometer.noise_sample.ENOUGH", 1000)
    whole = observation(1, 2, 3, 4)
    (sample,) = accumulate(
        VisibilitySet(whole.phase_centre, whole.blocks), [NoiseSampleAccumulator()]
    )
    # Two chunks of 960, of which nine tenths have weight.
    assert 1500 < len(sample.here) < 1920
