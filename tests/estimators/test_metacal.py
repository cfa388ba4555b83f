"""Metacalibration of any estimator, on a measured or a simulated facet."""

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
import pytest

from tests.estimators.facets import in_other_unit, source_facet
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.estimate import estimate_sample_shear
from uvshear.estimators.estimator import Estimator
from uvshear.estimators.mean import Mean
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.shapes.source_facet import noise_named
from uvshear.shapes.statistic_flag import StatisticFlag


def test_sources_of_other_fields_have_other_noise():
    here, there = source_facet(name=(1, 7)), source_facet(name=(2, 7))
    metacal = Metacal()
    assert metacal.statistic(here)["mc1"] != metacal.statistic(there)["mc1"]


def test_the_seed_changes_the_noise_that_is_added():
    source = source_facet()
    first, again, other = (Metacal(seed=seed).statistic(source)["mc1"] for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_a_round_beam_is_no_wider_than_the_array():
    """MeerKAT's, of a bright galaxy; a beam as wide as SKA-Mid's has responses between -10 and 110 there."""
    source = source_facet(longest=25e3)
    metacal = Metacal()
    for number in range(3):
        noise = noise_named((1, number), len(source.facet.power))
        kept = metacal.statistic(replace(source, draw_noise=noise))
        response = np.array([kept["mc_r11"], kept["mc_r22"]])
        assert np.all((response > 5) & (response < 25))
        assert abs(kept["mc_r12"]) < 0.6 * response.min()


def test_sources_of_one_beam_share_the_round_beam_whatever_their_unit():
    source, metacal = source_facet(), Metacal()
    metacal.statistic(source)
    metacal.statistic(in_other_unit(source, 1.3))
    assert len(metacal._beams) == 1


@dataclass(frozen=True)
class Fickle(Estimator):
    """Fails at its third measurement."""

    calls: list[int] = field(default_factory=list)

    name = "fickle"
    columns: ClassVar = {}

    def statistic(self, source):
        self.calls.append(1)
        return None if len(self.calls) == 3 else {"first": 0.1}

    def terms(self, sample, about):
        value = np.stack([sample["first"], np.zeros(len(sample))], axis=-1)
        return Terms(value, np.broadcast_to(np.eye(2), (len(sample), 2, 2)))


def test_a_source_of_which_one_measurement_fails_has_no_statistic():
    """Its response would be that of the failure."""
    assert Metacal(Fickle()).statistic(source_facet()) is StatisticFlag.NOT_FITTED


def test_a_source_that_was_never_measured_has_no_statistic():
    class Blind(Fickle):
        def statistic(self, source):
            return None

    assert Metacal(Blind()).statistic(source_facet()) is StatisticFlag.NOT_FITTED


def test_moments_behind_a_round_beam_respond_as_they_say_themselves():
    """Both by differences of sheared data and in closed form."""
    source = source_facet(noise=0.0)
    quiet = replace(source, draw_noise=lambda _: np.zeros(len(source.facet.power), complex))
    moments = Moments()
    kept = Metacal(moments).statistic(quiet)
    own = moments.statistic(quiet)
    weight = moments.terms(Sample.from_rows([{**own, "flux": source.flux}]), np.zeros(1, complex))
    ratio = kept["mc1"] / weight.value[0, 0]
    measured = np.array([[kept[f"mc_r{i}{j}"] for j in (1, 2)] for i in (1, 2)])
    # the round beam changes the weight of the galaxy and little else: measured 0.4 per cent
    np.testing.assert_allclose(measured, ratio * weight.response[0], rtol=0.02, atol=0.01)


def test_terms_are_the_kept_numbers():
    sample = Sample(
        {name: np.array([k + 1.0, np.nan]) for k, name in enumerate(Metacal.columns)}, np.zeros(2)
    )
    terms = Metacal().terms(sample, np.zeros(2, complex))
    np.testing.assert_array_equal(terms.value[0], [1, 2])
    np.testing.assert_array_equal(terms.response[0], [[3, 4], [5, 6]])
    assert terms.tells.tolist() == [True, False]


def test_what_is_wrapped_is_told():
    assert Metacal().record() == {"wraps": "mean"}
    wrapped = Metacal(Bayesian()).record()
    assert (wrapped["wraps"], wrapped["prior"]) == ("bayesian", "paper")


def test_a_wrapped_estimator_learns_before_the_measurement_or_not_at_all():
    metacal = Metacal(Bayesian(fits_population=True))
    assert metacal.is_learning
    assert metacal.learner is metacal.wrapped
    sample = Sample({name: np.ones(3) for name in metacal.columns}, np.zeros(3))
    with pytest.raises(
        InputError, match="'metacal' wraps 'bayesian' with a population that is yet"
    ):
        estimate_sample_shear(metacal, sample)
    assert not Metacal(Mean()).is_learning
