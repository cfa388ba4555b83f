"""The bias of an estimator, in one call."""

import cmath
from dataclasses import replace

import numpy as np
import pytest

import uvshear.bias.estimate
from tests.bias.surveys import SHEARS, plan
from uvshear.bias.estimate import estimate_bias, opposite_shears
from uvshear.bias.fit import Bias
from uvshear.bias.survey import Survey
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.moments import Moments
from uvshear.execution import SERIAL, Resources

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
    assert found is bias
    assert seen["estimators"] == [Moments()]
    assert seen["experiment"].shears == pytest.approx(SHEARS)
    assert len(seen["experiment"].galaxies) == 20


def test_an_estimator_that_learns_has_no_crowd():
    survey = replace(SHORT, plan=plan(integration=7200.0))
    with pytest.raises(InputError, match="'bayesian' learns from a sample"):
        estimate_bias(
            Bayesian(fits_population=True),
            galaxies=20,
            survey=survey,
            density=4.0,
            resources=ALONE,
        )
