"""Noise that the visibilities themselves tell of."""

from dataclasses import replace

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.noise_estimate import noise_over_weights, scaled_to_its_noise
from uvshear.interferometer.visibilities import Integrations, Visibilities, VisibilitySet

BASELINES, TIMES = 40, 30


def _seen(channels: int, sky=0.0) -> Visibilities:
    """Noise of three times what the weights say, rows sorted by time."""
    rng = np.random.default_rng(1)
    shape = BASELINES * TIMES, channels
    weights = rng.uniform(0.5, 2, shape)
    noise = rng.standard_normal((2, *shape))
    pair = np.tile(np.arange(BASELINES), TIMES)
    return Visibilities(
        np.ones((shape[0], 3)),
        np.linspace(1e9, 1.1e9, channels),
        sky + 3 * (noise[0] + 1j * noise[1]) / np.sqrt(weights),
        weights,
        integrations=Integrations(
            np.column_stack([pair, pair + 1]),
            np.repeat(np.arange(TIMES) * 8.0, BASELINES),
            np.full(shape[0], 8.0),
        ),
    )


def ratio(*blocks):
    return noise_over_weights(VisibilitySet(PhaseCentre(0.0, 0.0), blocks))


@pytest.mark.parametrize("channels", [1, 4])
def test_the_scatter_of_neighbours_tells_the_noise(channels):
    seen = _seen(channels)
    # error of a median of 1160 exponential numbers or more: 1.5 per cent of sigma
    assert ratio(seen) == pytest.approx(3.0, rel=0.05)


def test_a_sky_that_varies_over_the_band_does_not_count_as_noise():
    seen = _seen(4, sky=100.0 * np.arange(4))
    assert ratio(seen) == pytest.approx(3.0, rel=0.05)


def test_a_sky_that_varies_in_time_does_not_count_as_noise():
    sky = 100.0 * np.repeat(np.arange(TIMES), BASELINES)[:, None]
    assert ratio(_seen(4, sky=sky)) == pytest.approx(3.0, rel=0.05)


def test_flagged_samples_are_not_looked_at():
    seen = _seen(4)
    seen.stokes_i[::2], seen.weights[::2] = 1e9, 0.0
    assert ratio(seen) == pytest.approx(3.0, rel=0.05)


def test_one_channel_without_baselines_tells_nothing():
    assert ratio(replace(_seen(1), integrations=None)) is None


def test_a_few_pairs_of_one_kind_do_not_beat_many_of_the_other():
    """One row of many channels too small is no evidence."""
    many = _seen(1)
    few = Visibilities(
        np.ones((55, 3)), np.linspace(1e9, 1.1e9, 3), np.zeros((55, 3), complex), np.ones((55, 3))
    )
    assert ratio(many, few) == pytest.approx(3.0, rel=0.05)


def test_each_set_is_scaled_to_its_own_noise():
    quiet = VisibilitySet(PhaseCentre(0.0, 0.0), (_seen(4),))
    scaled = scaled_to_its_noise(quiet)
    assert noise_over_weights(scaled) == pytest.approx(1.0, rel=1e-3)
    with pytest.raises(InputError, match="cannot be estimated from neighbouring samples"):
        scaled_to_its_noise(VisibilitySet(PhaseCentre(0.0, 0.0), ()))
