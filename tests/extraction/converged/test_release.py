"""A sky without the prior on ellipticities: it moves towards the truth, and statistics lose nothing to neighbours."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.states import nothing, touching_pair
from tests.extraction.fields import OPTIONS, extract
from tests.skies import galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.estimators.moments import Moments
from uvshear.execution import SERIAL
from uvshear.extraction.converged import extraction as converged
from uvshear.extraction.converged.minor_cycle import run_minor_cycle
from uvshear.extraction.converged.release import RELEASES, release
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import predict_visibilities

FREQUENCY = np.array([1.35e9, 1.45e9])

RNG = np.random.default_rng(8)
COUNT = 30
SKY = galaxies(
    l=RNG.uniform(-40, 40, COUNT) * ARCSEC,
    m=RNG.uniform(-40, 40, COUNT) * ARCSEC,
    flux=np.full(COUNT, 1e-3),
    alpha=RNG.uniform(1.8, 2.2, COUNT) * ARCSEC,
    e=0.4 * np.exp(2j * np.pi * RNG.uniform(size=COUNT)),
)


def test_a_released_sky_moves_from_the_prior_to_the_truth():
    prepared = touching_pair(snr_factor=0.02)
    held, _ = run_minor_cycle(prepared.state, 0.01, SERIAL, nothing, afresh=True)
    released, moves = release(held, 0.005, SERIAL, nothing)
    truth = prepared.truth.ellipticity
    part_held, part_released = (
        np.abs(prepared.ellipticities(state)) / np.abs(truth) for state in (held, released)
    )
    assert np.all(part_held < 0.97)
    assert np.all(np.abs(part_released - 1) < 0.5 * np.abs(part_held - 1))
    assert len(moves) == RELEASES
    assert moves[0] > moves[1] > moves[2]
    # The sky that it begins with keeps its priors and its place.
    assert held.sources == prepared.state.sources
    assert np.max(released.change_since(held.fits)) > moves[1]


def _seen(sky, snr):
    """Observe without noise, with weights as if there were noise."""
    uvw, centre = vla("b", samples=6)
    vis = predict_visibilities(sky, uvw, FREQUENCY)
    # About half of the flux is resolved.
    sigma = 0.5 * 1e-3 * np.sqrt(vis.size) / snr
    weights = np.full(vis.shape, sigma**-2)
    return VisibilitySet(centre, (Visibilities(uvw, FREQUENCY, vis, weights),))


def _moments(sky, snr):
    observation = _seen(sky, snr)
    catalogue = catalogue_from_galaxies(sky, observation.phase_centre)
    kept = extract(observation, catalogue, replace(OPTIONS, keep=(Moments(),))).kept
    return np.array([[kept[k]["m1"], kept[k]["m2"]] for k in range(len(sky))])


@pytest.fixture(scope="module")
def alone():
    """Moments are linear: those of each by itself."""
    return np.concatenate([_moments(SKY.select(np.array([k])), 10.0) for k in range(COUNT)])


def _part(moments, alone):
    return float(np.sum(moments * alone) / np.sum(alone**2))


def test_neighbours_take_nothing_of_a_faint_galaxys_moments(alone, monkeypatch):
    released = _part(_moments(SKY, 10.0), alone)
    monkeypatch.setattr(converged, "release", lambda state, *_: (state, ()))
    held = _part(_moments(SKY, 10.0), alone)
    # measured 0.995 and 0.897; one minor cycle: 0.970
    assert held < 0.92
    assert released == pytest.approx(1.0, abs=0.01)
