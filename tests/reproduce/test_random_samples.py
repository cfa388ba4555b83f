import math

import numpy as np
import pytest

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.geometry.directions import n_minus_one_at
from uvshear.interferometer.coverage import synthesise
from uvshear.reproduce.paper_pointing import BAND, PaperPointing
from uvshear.reproduce.random_samples import RandomSamples, Resolution

L, M = 0.004, -0.003


def _draw(resolution: Resolution, number: int = 2000) -> RandomSamples:
    return RandomSamples.draw(PaperPointing(), resolution, number, np.random.default_rng(2))


def test_baselines_are_those_of_the_synthesis():
    """With one integration of the whole track all samples are at transit."""
    samples = _draw(Resolution(BAND[1] - BAND[0], 8 * 3600.0))
    plan = PaperPointing(integration=8 * 3600.0).plan
    coverage = synthesise(plan.layout, plan.track)
    known = {tuple(np.round(row, 3)) for row in coverage.uvw.tolist()}
    assert {tuple(np.round(row, 3)) for row in samples.uvw.tolist()} <= known
    assert samples.frequency == pytest.approx(np.full(2000, 1.07e9))


def test_what_averages_keep_is_the_mean_of_the_phases():
    samples = _draw(Resolution(2e6, 20.0), 300)
    direction = np.array([L, M, n_minus_one_at(L, M)])
    steps = (np.arange(200) - 99.5) / 200
    delay = samples.uvw @ direction / SPEED_OF_LIGHT
    change = samples.drift @ direction * samples.frequency / SPEED_OF_LIGHT
    by_channel = np.exp(2j * math.pi * np.outer(delay * 2e6, steps)).mean(axis=1)
    by_time = np.exp(2j * math.pi * np.outer(change, steps)).mean(axis=1)
    expected = (by_channel * by_time).real
    np.testing.assert_allclose(samples.kept(L, M), expected, atol=1e-3)
    assert samples.kept(L, M).min() < 0.9
    np.testing.assert_allclose(samples.kept(0.0, 0.0), 1)


def test_samples_fill_the_band_and_the_track():
    samples = _draw(Resolution(30e3, 0.5))
    assert samples.frequency.min() < 960e6
    assert samples.frequency.max() > 1180e6
    uv = samples.uv_from(L, M)
    assert uv.shape == (2000, 2)
    assert np.hypot(*uv.T).max() > 2e5
