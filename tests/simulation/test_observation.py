"""Simulated observations."""

from dataclasses import replace

import numpy as np
import pytest

from uvshear.execution import SERIAL, in_threads
from uvshear.galaxy import Exponential, Galaxies
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import CorrelationNoise, ScaledNoise
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import Observation
from uvshear.predict import predict_visibilities
from uvshear.simulation import observation as module
from uvshear.simulation.observation import SimulatedObservation

GALAXIES = Galaxies(
    l=np.array([1e-3, -4e-4]),
    m=np.array([2e-3, 3e-4]),
    flux=np.array([1e-3, 2e-3]),
    scale_length=np.array([0.0, 5e-6]),
    ellipticity=np.array([0, 0.2 + 0.1j]),
    spectral_index=np.array([-0.7, -0.7]),
)


def _observation(seed=1, channels=3, noise=None, integration=60.0):
    track = Track.from_clock(PhaseCentre(1.0, -0.5), ((-3600.0, 3600.0),), integration)
    return SimulatedObservation(
        coverage=synthesise(load_layout("ska-mid-aa2"), track),
        channels=Channels.from_band(950e6, 1190e6, channels),
        galaxies=GALAXIES,
        profile=Exponential(),
        noise=noise or ScaledNoise(1e-3),
        seed=seed,
    )


def _correlations(observation, executor=SERIAL):
    return np.concatenate([block.correlations for block in observation.blocks(executor)])


def test_without_noise_both_hands_are_the_prediction():
    observation = _observation(seed=None)
    expected = predict_visibilities(
        GALAXIES, observation.coverage.uvw, observation.channels.frequency, Exponential()
    )
    for hand in np.moveaxis(_correlations(observation), 2, 0):
        np.testing.assert_allclose(hand, expected, rtol=1e-6, atol=1e-9)


def test_noise_has_the_sigma_that_is_stated():
    observation = _observation(noise=CorrelationNoise(400.0), integration=30.0)
    clean = _correlations(_observation(seed=None, noise=CorrelationNoise(400.0), integration=30.0))
    sigma = np.concatenate([block.sigma for block in observation.blocks()])
    pulls = ((_correlations(observation) - clean) / sigma).view(np.float32).ravel()
    # 6 million deviates: variance to 6e-4, mean to 4e-4
    assert len(pulls) > 5.7e6
    assert abs(pulls.astype(float).mean()) < 2e-3
    assert abs(pulls.astype(float).var() - 1) < 3e-3


def test_the_four_components_of_the_noise_are_independent():
    noise = _correlations(_observation()) - _correlations(_observation(seed=None))
    components = noise.view(np.float32).reshape(-1, 4).T
    correlation = np.corrcoef(components) - np.eye(4)
    assert np.abs(correlation).max() < 5 / np.sqrt(components.shape[1])


def test_the_same_seed_gives_the_same_noise_whatever_the_executor_and_blocks(monkeypatch):
    observation = replace(_observation(), is_exact=True)
    monkeypatch.setattr(module, "SAMPLES_PER_SLAB", 3 * 1000)
    together = _correlations(observation)
    monkeypatch.setattr(module, "SLABS_PER_BLOCK", 1)
    assert len(list(observation.blocks())) > 100
    np.testing.assert_array_equal(_correlations(observation, executor=in_threads(2)), together)


def test_predictions_are_wrong_by_a_small_part_of_the_noise_unless_they_are_exact():
    quick, exact = (
        _correlations(replace(_observation(), is_exact=is_exact)) for is_exact in (False, True)
    )
    sigma = np.concatenate([block.sigma for block in _observation().blocks()])
    wrong = np.abs(quick - exact) / sigma
    assert 0 < np.sqrt(np.mean(wrong**2)) < module.OF_THE_NOISE
    without_noise = _correlations(_observation(seed=None))
    expected = _correlations(replace(_observation(seed=None), is_exact=True))
    np.testing.assert_array_equal(without_noise, expected)


def test_another_seed_gives_other_noise():
    assert not np.any(_correlations(_observation(1)) == _correlations(_observation(2)))


def test_slabs_do_not_repeat_one_another(monkeypatch):
    observation = _observation(channels=1)
    monkeypatch.setattr(module, "SAMPLES_PER_SLAB", 2016)
    noise = _correlations(observation) - _correlations(_observation(seed=None, channels=1))
    slabs = noise.reshape(-1, 2016 * 2)
    assert len(np.unique(slabs[:, 0])) == len(slabs)


def test_blocks_follow_one_another(monkeypatch):
    monkeypatch.setattr(module, "SAMPLES_PER_SLAB", 3 * 500)
    observation = _observation()
    row = 0
    for block in observation.blocks():
        assert block.first_row == row
        assert block.correlations.dtype == np.complex64
        row += len(block)
    assert row == len(observation.coverage)


def test_it_is_an_observation_of_stokes_i():
    observation = _observation()
    assert isinstance(observation, Observation)
    assert observation.phase_centre == PhaseCentre(1.0, -0.5)
    chunk = next(observation.chunks())
    np.testing.assert_allclose(chunk.weights, 1e6, rtol=1e-6)
    clean = next(_observation(seed=None).chunks())
    noise = (chunk.stokes_i - clean.stokes_i).view(np.float32)
    assert np.std(noise) == pytest.approx(1e-3, rel=0.01)
