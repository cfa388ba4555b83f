"""Facets that are drawn, against those that come from visibilities."""

from dataclasses import replace

import numpy as np
import pytest

from tests.bias.surveys import one_galaxy, plan
from uvshear.bias.mock_facets import WIDEST, FacetSimulator
from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline.measure import measure
from uvshear.pipeline.simulate import simulate
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.moments import MomentFunctional
from uvshear.shapes.prior import ShapePrior
from uvshear.simulation.population import Population


# These data have no noise.
@pytest.mark.filterwarnings("ignore::uvshear.errors.DataWarning")
def test_what_is_drawn_is_what_visibilities_come_to(beam):
    """Moments of a galaxy from its visibilities, through the whole measurement, and from the beam alone."""
    flux, e, alpha = 5e-5, 0.3 - 0.2j, 1.4 * ARCSEC
    sky = one_galaxy(flux, alpha, e, spectral_index=-0.7)
    catalogue = catalogue_from_galaxies(sky, plan().track.phase_centre)
    observation = simulate(catalogue, plan(), seed=None)
    kept = measure(observation, catalogue, keep="moments").statistics[0]

    size = Population().size.prior(sky.flux)
    simulator = beam.simulator(float(size.log_median[0]), float(size.sigma[0]))
    functional = MomentFunctional(
        simulator.cutout.uv, simulator.power, simulator.cutout.size * simulator.cutout.pixel
    )
    galaxy = GalaxyFit(flux, np.zeros(2), e, alpha, 0.0)
    nothing = np.zeros(len(simulator.power), complex)
    drawn = functional.measure(simulator.facet(galaxy, Exponential(), nothing).correlation)

    scale = drawn.size
    names = ("m1", "m2", "m_size", "r11", "r12", "r22", "r_third")
    got = np.array([kept[name] for name in names]) / scale
    responses = drawn.response.ravel()[[0, 1, 3]]
    expected = np.array([*drawn.shape, drawn.size, *responses, drawn.third]) / scale
    # measured 4e-3 in the derivatives, of the track's few samples and the baselines left out below 3 kilo-wavelengths
    np.testing.assert_allclose(got, expected, atol=6e-3)
    noise = np.sqrt([kept["m1_var"], kept["m2_var"]])
    np.testing.assert_allclose(noise, np.sqrt(np.diag(drawn.covariance)[:2]), rtol=0.1)


def test_noise_comes_back_after_four_turns(beam):
    simulator = beam.simulator(np.log(1.0 * ARCSEC), 0.3)
    noise = simulator.draw_noise(np.random.default_rng(2))
    again = noise
    for _ in range(4):
        again = simulator.turned(again)
    np.testing.assert_array_equal(again, noise)


def test_a_turn_of_the_noise_is_that_of_the_sky(beam):
    """A turned galaxy's model is the turned model: V(u, v) goes with v, -u."""
    simulator = beam.simulator(np.log(1.0 * ARCSEC), 0.3)
    flat = FacetSimulator(simulator.cutout, np.ones(len(simulator.power)))
    nothing = np.zeros(len(flat.power), complex)

    def model(position, e):
        galaxy = GalaxyFit(1.0, np.array(position), e, ARCSEC, 0.0)
        return flat.facet(galaxy, Exponential(), nothing).correlation

    still, turned = model((3e-6, 1e-6), 0.3 + 0.1j), model((-1e-6, 3e-6), -0.3 - 0.1j)
    np.testing.assert_allclose(flat.turned(still), turned, atol=1e-5)


def test_the_noise_has_the_variance_of_the_power(beam):
    simulator = beam.simulator(np.log(1.0 * ARCSEC), 0.3)
    rng = np.random.default_rng(5)
    galaxy = GalaxyFit(0.0, np.zeros(2), 0j, ARCSEC, 0.0)
    is_seen = simulator.power > 0
    pulls = []
    for _ in range(20):
        facet = simulator.facet(galaxy, Exponential(), simulator.draw_noise(rng))
        pulls.append(facet.correlation[is_seen] / np.sqrt(facet.power[is_seen]))
    for part in (np.real(pulls), np.imag(pulls)):
        assert np.var(part) == pytest.approx(1, abs=0.02)


def test_simulators_are_made_once_for_galaxies_of_like_size(beam):
    first = beam.simulator(np.log(1.0 * ARCSEC), 0.3)
    assert beam.simulator(np.log(1.0 * ARCSEC), 0.3) is first
    larger = beam.simulator(np.log(3.0 * ARCSEC), 0.3)
    assert larger.cutout.size > first.cutout.size
    assert beam.simulator(np.log(300.0 * ARCSEC), 0.3).cutout.size <= WIDEST


def test_the_signal_to_noise_ratio_is_that_of_the_facet(beam):
    simulator = beam.simulator(np.log(1.0 * ARCSEC), 0.3)
    prior = ShapePrior(np.log(1.0 * ARCSEC), 0.3)
    galaxy = GalaxyFit(2e-5, np.zeros(2), 0j, 1.0 * ARCSEC, 0.0)
    nothing = np.zeros(len(simulator.power), complex)
    facet = replace(simulator).facet(galaxy, Exponential(), nothing)
    is_seen = facet.power > 0
    expected = np.sqrt(np.sum(np.abs(facet.correlation[is_seen]) ** 2 / facet.power[is_seen]))
    assert 2e-5 * simulator.snr_of_jansky(prior, Exponential()) == pytest.approx(expected)
