"""Galaxies of a catalogue, observed with an array."""

from dataclasses import replace

import numpy as np
import pytest

from uvshear.errors import DataWarning
from uvshear.galaxy import SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre, local_north
from uvshear.geometry.ellipticity import add_shear, to_field_frame
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.noise import StokesINoise
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.io.catalogue import Catalogue, write_catalogue
from uvshear.pipeline.simulate import simulate
from uvshear.predict import predict_visibilities
from uvshear.simulation.lensing import shear_at_fixed_scale_length

CENTRE = PhaseCentre(1.0, np.radians(70.0))


@pytest.fixture
def plan():
    track = Track.from_clock(CENTRE, ((-600.0, 600.0),), 600.0)
    return ObservingPlan(load_layout("vla-b"), track, Channels.from_band(1.4e9, 1.5e9, 2))


@pytest.fixture
def catalogue():
    return Catalogue(
        identifier=np.arange(3),
        flux=np.array([1e-4, 2e-4, 3e-4]),
        spectral_index=np.full(3, -0.7),
        l=np.array([0.0, 0.01, -0.01]),
        m=np.array([0.0, 0.005, 0.01]),
        scale_length=np.full(3, 1e-5),
        ellipticity=np.array([0.1, 0.2j, -0.1 + 0.1j]),
    )


def test_what_is_simulated_without_noise_is_the_prediction(plan, catalogue):
    observation = simulate(catalogue, plan, seed=None)
    chunk = next(iter(observation.chunks()))
    sky = catalogue.galaxies(CENTRE)
    expected = predict_visibilities(sky, chunk.uvw, chunk.frequency)
    np.testing.assert_allclose(chunk.stokes_i, expected, rtol=0, atol=1e-6 * sky.flux.sum())
    assert np.all(chunk.weights > 0)


def test_a_shear_is_in_the_frame_of_local_north(plan, catalogue):
    g = 0.05 + 0.02j
    sheared = simulate(catalogue, plan, shear=g).galaxies
    sky = catalogue.galaxies(CENTRE)
    local = to_field_frame(np.full(3, g), local_north(CENTRE, sky.l, sky.m))
    np.testing.assert_allclose(sheared.ellipticity, add_shear(sky.ellipticity, local))
    # At this declination the frame turns by more than the shear would forgive.
    assert np.ptp(np.angle(local)) > 0.05


def test_the_catalogue_shears_each_galaxy_by_itself(plan, catalogue):
    each = np.array([0.05, 0.02j, -0.03 + 0.01j])
    own = simulate(replace(catalogue, shear=each), plan).galaxies
    for k, g in enumerate(each):
        alone = simulate(catalogue, plan, shear=complex(g)).galaxies
        assert own.ellipticity[k] == pytest.approx(alone.ellipticity[k])
        assert own.scale_length[k] == pytest.approx(alone.scale_length[k])


def test_the_paper_s_lens_keeps_the_scale_length(plan, catalogue):
    found = simulate(catalogue, plan, shear=0.1, lens=shear_at_fixed_scale_length).galaxies
    np.testing.assert_array_equal(found.scale_length, catalogue.scale_length)
    assert np.any(simulate(catalogue, plan, shear=0.1).galaxies.scale_length != 1e-5)


def test_a_catalogue_is_taken_from_its_file(plan, catalogue, tmp_path):
    path = tmp_path / "cat.fits"
    write_catalogue(path, catalogue)
    found = simulate(str(path), plan).galaxies
    np.testing.assert_allclose(found.flux, catalogue.flux)


def test_the_noise_is_the_one_that_is_given(plan, catalogue):
    weights = [
        next(iter(simulate(catalogue, plan, noise=StokesINoise(sefd)).chunks())).weights
        for sefd in (400.0, 800.0)
    ]
    np.testing.assert_allclose(weights[0] / weights[1], 4)
    usual = [next(iter(simulate(catalogue, plan, seed=s).chunks())).stokes_i for s in (1, 1, 2)]
    np.testing.assert_array_equal(usual[0], usual[1])
    assert np.any(usual[0] != usual[2])


def test_sizes_that_a_catalogue_lacks_are_drawn_and_told(plan):
    """Galaxies that become points would be measured as unresolved, and their ellipticities follow the beam."""
    flux = np.full(400, 1e-4)
    rng = np.random.default_rng(1)
    sources = Catalogue(
        identifier=np.arange(400),
        flux=flux,
        spectral_index=np.full(400, -0.7),
        l=rng.uniform(-1e-3, 1e-3, 400),
        m=rng.uniform(-1e-3, 1e-3, 400),
        is_point=np.arange(400) < 10,
    )
    with pytest.warns(DataWarning, match="no column scale_length"):
        observation = simulate(sources, plan, seed=5)
    drawn = observation.galaxies.scale_length
    assert np.all(drawn[:10] == 0)
    relation = SizeFluxRelation()
    prior = relation.prior(flux[:1])
    pulls = (np.log(drawn[10:]) - prior.log_median[0]) / prior.sigma[0]
    assert abs(pulls.mean()) < 3 / np.sqrt(390)
    assert abs(pulls.std() - 1) < 3 / np.sqrt(2 * 390)
    with pytest.warns(DataWarning):
        again = simulate(sources, plan, seed=5)
    np.testing.assert_array_equal(again.galaxies.scale_length, drawn)


def test_only_the_sizes_that_are_missing_are_drawn(plan, catalogue):
    partial = replace(catalogue, scale_length=np.array([1e-5, np.nan, 3e-5]))
    with pytest.warns(DataWarning, match="no scale_length for 1 of its 3 sources"):
        drawn = simulate(partial, plan, seed=None).galaxies.scale_length
    assert drawn[[0, 2]].tolist() == [1e-5, 3e-5]
    assert 0 < drawn[1] < 1e-4
