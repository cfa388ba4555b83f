"""Removal of a simulated bias from a shear."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest

from uvshear.errors import DataWarning, InputError
from uvshear.estimators.bias import Bias, BiasSimulation
from uvshear.estimators.bias_removal import check_removable, remove_bias
from uvshear.estimators.shear_estimate import ShearConditions, ShearEstimate

CONDITIONS = ShearConditions("mean", flux_min=20e-6)


def _bias(m=(-0.1, 0.05), m_err=(0.01, 0.0), c=(2e-3, 0.0), c_err=(1e-3, 0.0), **more):
    parts = {"name": "all", "n": 50, "simulation": BiasSimulation(CONDITIONS)} | more
    values = {"m": m, "m_err": m_err, "c": c, "c_err": c_err, "response": (1.0, 1.0)}
    return Bias(**{name: np.array(value, float) for name, value in values.items()}, **parts)


def test_the_bias_is_removed_and_its_errors_are_added():
    part = ShearEstimate(0.9 * 0.03 + 2e-3, 4e-3, 1.05 * -0.02, 5e-3, 100, "mean")
    measured = replace(part, bins={"10-20 uJy": part, "20-50 uJy": part})
    got = remove_bias(_bias(bins=(_bias(m=(0.0, 0.0), name="10-20 uJy"),)), measured)
    assert got.g1 == pytest.approx(0.03)
    assert got.g2 == pytest.approx(-0.02)
    # (4e-3)^2 + (1e-3)^2 + (0.03 x 0.01)^2, over 0.9
    assert got.g1_err == pytest.approx(math.sqrt(4e-3**2 + 1e-3**2 + 3e-4**2) / 0.9)
    assert got.g2_err == pytest.approx(5e-3 / 1.05)
    assert (got.n, got.estimator, got.frame) == (100, "mean", "sky")
    # A bin has a bias of its own; one that was not simulated is left out.
    assert list(got.bins) == ["10-20 uJy"]
    assert got.bins["10-20 uJy"].g1 == pytest.approx(part.g1 - 2e-3)


def test_errors_after_the_removal_are_those_of_draws():
    """To first order, the error is the scatter of corrected shears when m, c and the shear scatter."""
    rng = np.random.default_rng(1)
    m, c = -0.1 + 0.01 * rng.normal(size=100_000), 1e-3 * rng.normal(size=100_000)
    measured = 0.045 + 2e-3 * rng.normal(size=100_000)
    bias = _bias(c=(0.0, 0.0))
    got = remove_bias(bias, ShearEstimate(0.045, 2e-3, 0.0, 1e-3, 100, "mean"))
    assert got.g1_err == pytest.approx(np.std((measured - c) / (1 + m)), rel=0.02)


def test_a_bias_of_the_same_conditions_is_accepted():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_removable(_bias(), CONDITIONS)


def _simulated(**changes):
    return _bias(simulation=BiasSimulation(replace(CONDITIONS, **changes)))


POPULATION = {"size": {"sigma": 0.35}}
NARROWER = {"size": {"sigma": 0.3}}


@pytest.mark.parametrize(
    ("bias", "own", "message"),
    [
        (_bias(frame="lm"), {}, "is in the frame 'lm'; the frame 'sky' is needed"),
        (_bias(m=(math.nan, 0.0)), {}, "lacks m, c or their errors"),
        (_bias(bins=(_bias(c_err=(math.nan, 0.0)),)), {}, "lacks m, c or their errors"),
        (_bias(m=(0.0, -1.5)), {}, "m is -1 or less"),
        (_bias(simulation=None), {}, "has no record of its simulation"),
        (
            _bias(simulation=BiasSimulation(CONDITIONS, flux_max=5e-5)),
            {},
            "an upper limit of the flux, 50 uJy",
        ),
        (
            _bias(simulation=BiasSimulation(CONDITIONS, position_sigma=1e-6)),
            {},
            "--position-error-arcsec",
        ),
        (
            _bias(simulation=BiasSimulation(CONDITIONS, keeps_scale_lengths=True)),
            {},
            "--legacy-shear",
        ),
        (_bias(), {"estimator": "moments"}, "with estimator = mean, but the shear is estimated"),
        (_bias(), {"snr_min": 10.0}, "with snr_min = 0, but the shear is estimated with"),
        (_bias(), {"flux_min": 0.0}, "with flux_min_ujy = 20, but the shear is estimated with"),
        (
            _bias(),
            {"averages_cells": True},
            "with facet = exact, but the shapes were measured with facet = cell-average",
        ),
        (_bias(), {"assumed": {"prior": "fitted"}}, "with prior = paper, but the shear"),
        (_bias(), {"assumed": {"wraps": "mean"}}, "with wraps = none, but the shear"),
        (
            _simulated(assumed={"prior": "file", "population": NARROWER}),
            {"assumed": {"prior": "file", "population": POPULATION}},
            "its population has size sigma = 0.3, but the population assumed for the shear has 0.35",
        ),
        (
            _simulated(assumed={"prior": "file"}),
            {"assumed": {"prior": "file", "population": POPULATION}},
            "has no population",
        ),
    ],
)
def test_a_bias_of_other_conditions_is_refused(bias, own, message):
    with pytest.raises(InputError) as error:
        check_removable(bias, replace(CONDITIONS, **own), "bias.json")
    assert str(error.value).startswith("bias.json: ")
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_cut_that_is_only_nearly_the_same_is_warned_of():
    own = replace(CONDITIONS, snr_min=10.0)
    simulation = BiasSimulation(own)
    with pytest.warns(
        DataWarning, match="were selected by the signal-to-noise ratio of their catalogue flux"
    ):
        check_removable(_bias(simulation=simulation), own)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_removable(_bias(simulation=replace(simulation, cuts_on_measured=True)), own)
