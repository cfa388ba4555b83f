"""Noise that the visibilities themselves tell of, and whether it is known."""

from dataclasses import replace

import numpy as np
import pytest

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.noise_estimate import Scatter, estimate_noise, noise_over_weights
from uvshear.interferometer.noise_sample import NoiseSampleAccumulator
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet

BASELINES, TIMES = 40, 60
NOISE = 3.0


def seen(channels=4, sky=0.0, hands=None, noise=NOISE, correlation=None) -> Visibilities:
    """Noise of three times what the weights say, rows sorted by time, on a sky that is given.

    ``correlation`` smooths the noise over the channels.
    """
    rng = np.random.default_rng(1)
    shape = BASELINES * TIMES, channels
    weights = rng.uniform(0.5, 2, shape)
    deviates = rng.standard_normal((2, *shape))
    if correlation is not None:
        deviates = np.stack([deviates @ correlation for deviates in deviates])
    pair = np.tile(np.arange(BASELINES), TIMES)
    length = 100.0 * (1 + pair)
    return Visibilities(
        np.column_stack([length, np.zeros(len(pair)), np.zeros(len(pair))]),
        np.linspace(1e9, 1.1e9, channels),
        sky + noise * (deviates[0] + 1j * deviates[1]) / np.sqrt(weights),
        weights,
        integrations=Integrations(
            np.column_stack([pair, pair + 1]),
            np.repeat(np.arange(TIMES) * 8.0, BASELINES),
            np.full(shape[0], 8.0),
        ),
        hand_powers=None if hands is None else hands**2 * rng.exponential(2, 4000),
    )


def sample_of(block):
    accumulator = NoiseSampleAccumulator()
    accumulator.add(block)
    return accumulator.result()


def over_time(step=100.0):
    return step * np.repeat(np.arange(TIMES), BASELINES)[:, None]


def random_phases(amplitude=30.0, channels=4):
    """A source so far away that its phase differs between any two samples."""
    turns = np.random.default_rng(2).uniform(size=(BASELINES * TIMES, channels))
    return amplitude * np.exp(2j * np.pi * turns)


def nothing(samples):
    return np.zeros(len(samples), complex)


@pytest.mark.parametrize("channels", [1, 4])
def test_neighbours_give_an_upper_limit(channels):
    found = estimate_noise(sample_of(seen(channels)))
    # error of a median of 2400 exponential numbers or more: 1.5 per cent of sigma
    assert found.ratio == pytest.approx(NOISE, rel=0.05)
    assert not found.is_certain
    assert found.exceeds()


@pytest.mark.parametrize("sky", [100.0 * np.arange(4), over_time()])
def test_a_sky_that_varies_over_the_band_or_in_time_does_not_count_as_noise(sky):
    assert estimate_noise(sample_of(seen(sky=sky))).ratio == pytest.approx(NOISE, rel=0.05)


@pytest.mark.parametrize("sky", [0.0, random_phases()])
def test_the_hands_tell_the_noise_whatever_the_sky(sky):
    found = estimate_noise(sample_of(seen(sky=sky, hands=NOISE)))
    assert found.ratio == pytest.approx(NOISE, rel=0.05)
    assert found.is_certain


@pytest.mark.parametrize("hands", [0.0, 0.1])
def test_copies_of_one_hand_do_not_count(hands):
    found = estimate_noise(sample_of(seen(hands=hands)), nothing)
    assert found.ratio == pytest.approx(NOISE, rel=0.05)
    assert found.is_certain


def test_hands_with_less_noise_than_the_weights_claim_are_believed_beside_a_bright_sky():
    """Weights that are a little off, and sources that are not in the catalogue."""
    block = seen(sky=random_phases(), hands=0.8, noise=0.8)
    found = estimate_noise(sample_of(block), nothing)
    assert found.ratio == pytest.approx(0.8, rel=0.05)
    assert found.is_certain


@pytest.mark.parametrize("noise", [0.8, 1.0, NOISE])
def test_a_residual_of_noise_alone_tells_it(noise):
    sky = random_phases(300.0)
    block = seen(sky=sky, noise=noise)
    known = dict(
        zip(block.stokes_i.ravel().astype(np.complex64).tolist(), sky.ravel(), strict=True)
    )

    def predict(samples):
        return np.array([known.get(vis, 0.0) for vis in samples.stokes_i.tolist()])

    found = estimate_noise(sample_of(block), predict)
    assert found.ratio == pytest.approx(noise, rel=0.05)
    assert found.is_certain
    assert found.is_near(noise)


@pytest.mark.parametrize("sky", [random_phases(3.0), random_phases(30.0)])
def test_a_source_in_the_residual_leaves_the_noise_unknown(sky):
    """Weights are right, nothing is fitted, and no neighbours are alike: the powers are not distributed as noise."""
    found = estimate_noise(sample_of(seen(sky=sky, noise=1.0)), nothing)
    assert not found.is_certain
    assert found.ratio > 1.5
    assert abs(np.log(found.contradicting.ratio / found.ratio)) > 0.1


def test_a_residual_on_short_baselines_leaves_the_noise_unknown():
    """An extended source that differs between integrations and channels, as noise does."""
    rng = np.random.default_rng(5)
    shape = BASELINES * TIMES, 4
    is_short = np.tile(np.arange(BASELINES) < BASELINES // 2, TIMES)[:, None]
    sky = 2 * is_short * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    found = estimate_noise(sample_of(seen(sky=sky, noise=1.0)), nothing)
    assert not found.is_certain


def test_neighbouring_channels_that_agree_with_the_weights_clear_them():
    """The sky that is left varies in time, but not over the band."""
    sky = over_time(30.0) * np.ones(4)
    found = estimate_noise(sample_of(seen(sky=sky, noise=1.0)), nothing)
    assert found.is_certain
    assert found.is_near()


def test_smoothed_channels_do_not_make_the_noise_too_small():
    """Hanning smoothing, with the noise of a channel as the weights claim it."""
    kernel = sum(
        weight * np.eye(64, k=k) for k, weight in ((-1, 0.25), (0, 0.5), (1, 0.25))
    ) / np.sqrt(0.375)
    block = seen(channels=64, noise=1.0, correlation=kernel)
    found = estimate_noise(sample_of(block), nothing)
    assert found.is_certain
    assert found.ratio == pytest.approx(1.0, abs=0.05)
    assert not estimate_noise(sample_of(block)).is_below()


def test_a_claim_other_than_one_is_what_weights_that_were_scaled_imply():
    """Scaled by a noise that neighbours have made 3 times too large; the residual tells the truth."""
    found = estimate_noise(sample_of(seen(noise=1 / 3)), nothing, claimed=1 / 3)
    assert found.ratio == pytest.approx(1 / 3, rel=0.05)
    assert found.is_near(1 / 3)
    assert not found.is_near()


def test_too_few_samples_tell_nothing():
    block = seen(channels=1)
    few = replace(
        block,
        uvw=block.uvw[:90],
        stokes_i=block.stokes_i[:90],
        weights=block.weights[:90],
        integrations=block.integrations.select(slice(90)),
    )
    assert estimate_noise(sample_of(few)) is None
    assert estimate_noise(sample_of(few), nothing) is None
    alone = replace(block, integrations=None)
    assert estimate_noise(sample_of(alone)) is None
    assert estimate_noise(sample_of(alone), nothing).ratio == pytest.approx(NOISE, rel=0.05)


def test_flagged_samples_are_not_looked_at():
    block = seen(4)
    block.stokes_i[::2], block.weights[::2] = 1e9, 0.0
    assert estimate_noise(sample_of(block)).ratio == pytest.approx(NOISE, rel=0.05)


def test_an_observation_is_read_for_its_noise():
    centre = PhaseCentre(0.0, 0.0)
    found = noise_over_weights(VisibilitySet(centre, (seen(),)))
    assert found.ratio == pytest.approx(NOISE, rel=0.05)
    assert noise_over_weights(VisibilitySet(centre, ())) is None


@pytest.mark.parametrize("quantile", [0.5, 0.9])
def test_the_error_of_an_estimate_is_its_scatter(quantile):
    rng = np.random.default_rng(3)
    drawn = [
        Scatter.from_powers(4 * rng.exponential(2, 400), "a simulation", quantile)
        for _ in range(1000)
    ]
    ratios = np.array([scatter.ratio for scatter in drawn])
    error = np.mean([scatter.error for scatter in drawn])
    assert np.mean(ratios) == pytest.approx(2, abs=0.01)
    # The scatter of 1000 is known to 2.2 per cent.
    assert np.std(ratios) == pytest.approx(error, rel=0.08)


def test_data_without_any_noise_contradict_a_sky_that_is_not_in_them():
    empty = sample_of(replace(seen(), stokes_i=np.zeros((BASELINES * TIMES, 4), complex)))
    found = estimate_noise(empty, lambda samples: 1.0 + samples.uvw[:, 0].astype(complex))
    assert found.ratio == 0
    assert not found.is_certain
    assert found.contradicting.ratio > 0.5
