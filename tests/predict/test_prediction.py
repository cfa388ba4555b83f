"""Predictions that have been planned: what they cost, and what they report."""

import numpy as np
import pytest

from tests.skies import galaxies, random_baselines
from uvshear.constants import ARCSEC
from uvshear.execution import SERIAL, in_threads
from uvshear.galaxy import Exponential
from uvshear.interferometer.attenuation import BandwidthSmearing
from uvshear.predict import by_grid, direct, drawable
from uvshear.predict.losses import Losses
from uvshear.predict.within_error import plan_within_error, predict_within_error

FREQUENCY = np.array([1.0e9, 1.1e9, 1.3e9])
LOSSES = Losses(BandwidthSmearing(), np.full(3, 2e6))
UVW = random_baselines(3000, 2e4)


def sky(number=40):
    l, m = np.random.default_rng(1).uniform(-0.003, 0.003, (2, number))
    return galaxies(l=l, m=m, alpha=ARCSEC)


def planned(losses, number=40):
    return plan_within_error(sky(number), UVW, FREQUENCY, 1e-4, Exponential(), losses=losses)


@pytest.fixture(autouse=True)
def _small_tasks(monkeypatch):
    """Images for most baselines, and many tasks."""
    monkeypatch.setattr(by_grid, "SLAB", 1000)
    monkeypatch.setattr(by_grid, "IN_A_SUM", 500)
    monkeypatch.setattr(direct, "SLAB", 200)
    monkeypatch.setattr(drawable, "SUM", 1e4)


@pytest.mark.parametrize("losses", [None, LOSSES])
@pytest.mark.parametrize("executor", [SERIAL, in_threads(2)])
def test_the_work_that_is_done_grows_to_all_of_it(losses, executor):
    told = []
    planned(losses).visibilities(executor, lambda *work: told.append(work))
    done, expected = np.array(told).T
    assert len(told) > 20
    assert np.all(np.diff(done) > 0)
    assert np.ptp(expected) == 0
    assert done[-1] == pytest.approx(expected[-1], rel=1e-9)


@pytest.mark.parametrize("losses", [None, LOSSES])
def test_those_who_listen_change_no_bit(losses):
    alone = planned(losses).visibilities()
    heard = planned(losses).visibilities(in_threads(2), lambda done, expected: None)
    at_once = predict_within_error(
        sky(), UVW, FREQUENCY, 1e-4, Exponential(), in_threads(2), losses
    )
    np.testing.assert_array_equal(alone, heard)
    np.testing.assert_array_equal(alone, at_once)


def test_images_report_the_cost_that_was_planned():
    told = []
    images = planned(None)
    images.visibilities(SERIAL, lambda *work: told.append(work))
    assert told[-1] == (round(images.cost), round(images.cost))
    assert sum(len(octave.tiles) for octave in images.octaves) > 1


def test_a_sky_without_galaxies_costs_nothing():
    nothing = planned(None, number=0)
    assert nothing.cost == 0
    assert not nothing.visibilities().any()
