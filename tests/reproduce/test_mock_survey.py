import numpy as np
import pytest

from tests.reproduce.surveys import POINTING, small_survey
from uvshear.bias.isolated import FITTED
from uvshear.constants import MICROJANSKY, SPEED_OF_LIGHT
from uvshear.diagnostics.weighting_loss import weighting_loss
from uvshear.galaxy import SizeFluxRelation
from uvshear.interferometer.weighting import RoundPsf, weighted
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template


def test_the_noise_gives_the_signal_to_noise_ratio():
    survey = small_survey(flux=20 * MICROJANSKY, snr=17.0)
    block = survey.samples().block
    uv = block.uvw[:, :2] * block.frequency[0] / SPEED_OF_LIGHT
    median = float(SizeFluxRelation().median(np.array([20 * MICROJANSKY]))[0])
    galaxy = GalaxyFit(20 * MICROJANSKY, np.zeros(2), 0j, median, 0.0)
    power = np.sum(block.weights[:, 0] * np.abs(Template(uv, FITTED).model(galaxy)) ** 2)
    assert np.sqrt(power) == pytest.approx(17.0, rel=1e-5)


def test_weights_are_scaled_for_the_median_galaxy():
    samples = small_survey(weightings=(RoundPsf(),)).samples()
    observation = weighted(POINTING.unit_visibilities(), [RoundPsf()])
    median = float(SizeFluxRelation().median(np.array([100 * MICROJANSKY]))[0])
    loss = weighting_loss(observation.map_baselines(), median, FITTED)
    assert samples.scale == pytest.approx(1 / loss.variance_over_beam, rel=1e-6)
    assert not np.allclose(samples.factors, 1)


def test_shears_are_turned_into_the_frame_of_the_sky():
    experiment = small_survey(shears=(0.01 + 0.02j, -0.01 - 0.02j)).experiment()
    assert experiment.shears == (0.01 - 0.02j, -0.01 + 0.02j)
    assert small_survey(shears=(0.01 + 0.02j, -0.01 - 0.02j)).experiment() is experiment
