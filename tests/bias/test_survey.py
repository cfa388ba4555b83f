"""What a survey makes of its observation: galaxies alone, or in a crowd."""

from dataclasses import replace

import numpy as np
import pytest

from tests.bias.surveys import SHEARS, plan
from uvshear.bias.cell_average import CellAverageBeam
from uvshear.bias.mock_facets import MockBeam
from uvshear.bias.survey import Survey
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.errors import InputError
from uvshear.galaxy import Exponential
from uvshear.shapes.prior import ShapePrior
from uvshear.simulation.noise_level import GalaxyNoise

SHORT = Survey(plan(integration=7200.0), snr_min=10.0)


def test_the_papers_is_a_track_of_eight_hours_of_ska_mid():
    paper = Survey.of_the_paper()
    assert len(paper.plan.layout) == 197
    assert np.degrees(paper.plan.track.phase_centre.dec) == pytest.approx(-30.0)
    assert paper.snr_min == 10.0


def test_an_experiment_has_what_the_survey_says():
    survey = replace(SHORT, flux_min=2e-5, flux_max=1e-4, position_sigma=1e-7, has_rings=False)
    experiment = survey.isolated(SHEARS, seed=4)
    assert isinstance(experiment.beam, MockBeam)
    for name in ("snr_min", "flux_min", "flux_max", "position_sigma", "has_rings", "lens"):
        assert getattr(experiment, name) == getattr(survey, name)
    assert (experiment.shears, experiment.seed) == (SHEARS, 4)


def test_the_papers_facets_have_a_beam_of_their_own():
    assert isinstance(replace(SHORT, averages_cells=True).isolated(SHEARS).beam, CellAverageBeam)


def test_the_noise_gives_the_galaxy_its_signal_to_noise_ratio():
    """Of 10 uJy, of the median size, round: 10 by the facet that is drawn."""
    experiment = SHORT.isolated(SHEARS)
    flux = np.array([10e-6])
    size = experiment.size.prior(flux)
    prior = ShapePrior(float(size.log_median[0]), float(size.sigma[0]))
    simulator = experiment.beam.simulator(prior.log_scale_length, prior.log_scale_length_sigma)
    assert 10e-6 * simulator.snr_of_jansky(prior, Exponential()) == pytest.approx(10, rel=0.02)
    quiet = replace(SHORT, noise=GalaxyNoise(10e-6, 20.0)).isolated(SHEARS)
    simulator = quiet.beam.simulator(prior.log_scale_length, prior.log_scale_length_sigma)
    assert 10e-6 * simulator.snr_of_jansky(prior, Exponential()) == pytest.approx(20, rel=0.02)


def test_a_crowd_has_its_density_and_the_survey_its_cuts():
    crowd = replace(SHORT, flux_min=15e-6).crowd(SHEARS, 20, 4.0, seed=6)
    assert len(crowd.galaxies) == 20
    half = np.sqrt(20 / 4.0) * ARCMIN / 2
    assert np.abs(crowd.galaxies.l).max() < half * 1.001
    np.testing.assert_array_equal(crowd.used & (crowd.galaxies.flux < 15e-6), np.zeros(20, bool))
    assert 0 < crowd.used.sum() < 20
    again = SHORT.crowd(SHEARS, 20, 4.0, seed=7)
    assert not np.array_equal(again.galaxies.flux, crowd.galaxies.flux)


@pytest.mark.parametrize(
    "setting",
    [
        {"measured_snr_min": 10.0},
        {"position_sigma": 0.1 * ARCSEC},
        {"has_rings": False},
        {"averages_cells": True},
    ],
)
def test_what_is_for_galaxies_alone_is_refused_in_a_crowd(setting):
    with pytest.raises(InputError, match="apply only to isolated galaxies"):
        replace(SHORT, **setting).crowd(SHEARS, 20, 4.0)
