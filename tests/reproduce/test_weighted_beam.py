import numpy as np
import pytest

from tests.reproduce.surveys import small_survey
from uvshear.bias.mock_facets import MockBeam
from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential
from uvshear.interferometer.weighting import RoundPsf
from uvshear.reproduce.weighted_beam import WeightedBeam
from uvshear.shapes.measurement import GalaxyFit


@pytest.fixture(scope="module")
def simulator():
    beam = small_survey(weightings=(RoundPsf(),)).experiment().beam
    assert isinstance(beam, WeightedBeam)
    simulator = beam.simulator(float(np.log(ARCSEC)), 0.3)
    assert beam.simulator(float(np.log(ARCSEC)), 0.3) is simulator
    return simulator


def test_natural_weights_need_no_second_beam():
    assert isinstance(small_survey().experiment().beam, MockBeam)


def test_the_noise_has_its_own_power(simulator):
    nothing = GalaxyFit(0.0, np.zeros(2), 0j, ARCSEC, 0.0)
    noise = simulator.draw_noise(np.random.default_rng(1))
    facet = simulator.facet(nothing, Exponential(), noise)
    np.testing.assert_allclose(facet.correlation, np.sqrt(simulator.noise_power) * noise)
    assert not np.allclose(simulator.noise_power, simulator.power, rtol=0.05)


def test_without_noise_the_galaxy_is_the_best_fit(simulator):
    galaxy = GalaxyFit(1e-4, np.zeros(2), 0.2 + 0.1j, ARCSEC, 0.0)
    facet = simulator.facet(galaxy, Exponential(), np.zeros(len(simulator.power), complex))
    np.testing.assert_allclose(
        facet.correlation.imag, 0, atol=1e-6 * np.abs(facet.correlation).max()
    )
