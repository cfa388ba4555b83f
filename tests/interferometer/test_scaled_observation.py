"""Weights that are scaled to the noise of the data."""

from dataclasses import replace

import numpy as np
import pytest

from tests.interferometer.chunks import CENTRE, observation
from uvshear.errors import InputError
from uvshear.interferometer.noise_estimate import noise_over_weights
from uvshear.interferometer.origin import origin_of
from uvshear.interferometer.scaled_observation import ScaledObservation, scaled_to_its_noise
from uvshear.interferometer.visibilities import VisibilitySet


def test_weights_and_hands_are_scaled():
    (block,) = observation(1).blocks
    block = replace(block, hand_powers=np.arange(4.0))
    (scaled,) = ScaledObservation(VisibilitySet(CENTRE, (block,)), 2.0).corrected(1.5).chunks()
    np.testing.assert_allclose(scaled.weights, block.weights / 9)
    np.testing.assert_allclose(scaled.hand_powers, np.arange(4.0) / 9)


def test_the_noise_that_is_found_is_that_of_the_scaled_weights():
    scaled = scaled_to_its_noise(observation(1, 2, 3, noise=3.0))
    assert scaled.noise == pytest.approx(3.0, rel=0.05)
    assert noise_over_weights(scaled).ratio == pytest.approx(1.0, rel=1e-3)
    assert not origin_of(scaled).weights_tell_noise


def test_data_without_noise_or_samples_are_refused():
    for nothing in (VisibilitySet(CENTRE, ()), observation(1, noise=0.0)):
        with pytest.raises(InputError, match="the noise cannot be estimated from the data"):
            scaled_to_its_noise(nothing)
