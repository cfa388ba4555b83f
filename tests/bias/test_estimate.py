"""The bias of an estimator, in one call."""

import cmath
from dataclasses import replace

import numpy as np
import pytest

import uvshear.bias.estimate
from tests.bias.surveys import SHEARS, plan
from uvshear.bias.estimate import estimate_bias, opposite_shears
from uvshear.bias.survey import Survey
from uvshear.errors import InputError
from uvshear.estimators import Bias
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.bias import BiasSimulation
from uvshear.estimators.moments import Moments
from uvshear.estimators.shear_estimate import ShearConditions
from uvshear.execution import SERIAL, Resources
from uvshear.simulation.lensing import shear_at_fixed_scale_length

SHORT = Survey(plan(), snr_min=10.0)
ALONE = Resources(SERIAL)


def test_opposite_shears_have_one_modulus_and_no_sum():
    first, second = opposite_shears(0.03)
    assert first == pytest.approx(0.03 * cmath.exp(0.25j * cmath.pi))
    assert second == pytest.approx(-first)
    many = opposite_shears(0.03, 8)
    assert abs(sum(many)) < 1e-15
    assert [abs(g) for g in many] == pytest.approx([0.03] * 8)
    assert opposite_shears(0.0) == (0j,)


def test_galaxies_alone_are_measured_by_the_name_of_an_estimator():
    done = []
    found = estimate_bias(
        "moments",
        galaxies=100,
        shear=0.03,
        seed=3,
        survey=SHORT,
        resources=ALONE,
        progress=lambda now, total: done.append((now, total)),
    )
    assert np.all(np.abs(found.m) < 2e-3 + 2 * found.m_err)
    assert found.n > 80
    assert found.bins
    # galaxies, and those of both first guesses
    assert done[-1] == (300, 300)


def test_shears_may_be_given():
    shears = (0.02j, -0.02j)
    found = estimate_bias(Moments(), galaxies=100, shear=shears, survey=SHORT, resources=ALONE)
    assert np.isfinite(found.m).tolist() == [False, True]
    assert found.simulation.shears == shears


def test_the_simulation_of_a_bias_is_known(monkeypatch):
    """Cuts on the fitted signal-to-noise ratio, and whatever measured shapes cannot have."""
    bias = Bias("all", *[np.zeros(2)] * 5, n=20)
    monkeypatch.setattr(
        uvshear.bias.estimate, "estimate_isolated_bias", lambda *arguments, **more: bias
    )
    survey = Survey(
        plan(integration=7200.0),
        lens=shear_at_fixed_scale_length,
        measured_snr_min=8.0,
        flux_min=20e-6,
        flux_max=50e-6,
        position_sigma=1e-7,
    )
    found = estimate_bias(Bayesian(), galaxies=20, seed=3, survey=survey, resources=ALONE)
    assert found.simulation == BiasSimulation(
        ShearConditions("bayesian", Bayesian().record(), 8.0, 20e-6),
        cuts_on_measured=True,
        flux_max=50e-6,
        keeps_scale_lengths=True,
        position_sigma=1e-7,
        shears=opposite_shears(0.02),
        seed=3,
    )


def test_a_density_makes_a_crowd(monkeypatch):
    """The measurement itself is tested in test_crowded."""
    seen = {}
    values = [np.zeros(2)] * 5
    bias = Bias("all", *values, n=20)

    def crowded(experiment, estimators, measure, progress):
        seen.update(experiment=experiment, estimators=estimators)
        return [bias]

    monkeypatch.setattr(uvshear.bias.estimate, "estimate_crowded_bias", crowded)
    survey = replace(SHORT, plan=plan(integration=7200.0))
    found = estimate_bias(
        "moments", galaxies=20, shear=0.03, survey=survey, density=4.0, resources=ALONE
    )
    assert (found.n, found.simulation.density, found.simulation.seed) == (20, 4.0, 1)
    assert found.simulation.conditions == ShearConditions("moments", snr_min=10.0)
    assert seen["estimators"] == [Moments()]
    assert seen["experiment"].shears == pytest.approx(SHEARS)
    assert len(seen["experiment"].galaxies) == 20


def test_an_estimator_that_learns_has_no_crowd():
    survey = replace(SHORT, plan=plan(integration=7200.0))
    with pytest.raises(InputError, match="'bayesian' fits its population to a sample"):
        estimate_bias(
            Bayesian(fits_population=True),
            galaxies=20,
            survey=survey,
            density=4.0,
            resources=ALONE,
        )
