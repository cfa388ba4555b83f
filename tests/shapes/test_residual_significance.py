"""What is left around a source, in standard deviations."""

from dataclasses import replace

import numpy as np
import pytest

from tests.shapes.facets import ALPHA, EXPONENTIAL, noise_free, noisy
from uvshear.shapes.residual_significance import REACH, SIGNIFICANT, residual_significance


def _significance(facet):
    return residual_significance(facet, EXPONENTIAL, ALPHA)


def _noise(seed):
    return noisy(np.random.default_rng(seed), snr=1e-6)[0]


def test_noise_alone_is_what_the_highest_of_a_hundred_places_would_be():
    highest = np.array([_significance(_noise(seed)) for seed in range(100)])
    # The highest modulus of 20 to 90 independent normal deviates: median 2.1 to 2.7.
    assert 2.0 < np.median(highest) < 3.0
    assert highest.max() < SIGNIFICANT


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("away", [0.0, 0.5, 0.85])
def test_a_galaxy_that_is_left_has_its_signal_to_noise_ratio(sign, away):
    facet, _ = noise_free(l=away * REACH * ALPHA, snr=20.0)
    left = replace(facet, correlation=sign * facet.correlation)
    # Between two places looked at a tenth is lost.
    assert 17.5 < _significance(left) <= 20.01


def test_what_is_left_far_away_does_not_count():
    facet, _ = noise_free(m=3 * REACH * ALPHA, snr=20.0)
    assert _significance(facet) < 5


def test_without_power_nothing_is_significant():
    facet = _noise(1)
    nothing = np.zeros_like(facet.power)
    assert _significance(replace(facet, power=nothing + 1e-300, correlation=nothing * 0j)) == 0
