"""The base class, and the rows of samples that come from facets."""

from dataclasses import dataclass

import numpy as np
import pytest

from tests.estimators.facets import in_other_unit, source_facet
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.estimate import sky_terms
from uvshear.estimators.estimator import Estimator, observe
from uvshear.estimators.mean import Mean
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.table_row import shape_values

ALL = [Mean(), Moments(), Bayesian(), Metacal(), Metacal(Moments()), Metacal(Bayesian())]


def _name(estimator):
    wrapped = getattr(estimator, "wrapped", None)
    return estimator.name if wrapped is None else f"{estimator.name} of {wrapped.name}"


@dataclass(frozen=True)
class Shapes(Estimator):
    """Needs no statistic."""

    name = "shapes"
    shape_columns = ("e1", "e2", "snr")

    def terms(self, sample, about):
        return Terms(np.zeros((len(sample), 2)), np.zeros((len(sample), 2, 2)))


def _measured(estimator, source):
    """Sample as a measurement keeps it: the columns of the shapes, and the statistic."""
    shapes = shape_values(source.shape, source.population)
    row = {name: {"flux": source.flux, **shapes}[name] for name in estimator.shape_columns}
    return Sample.from_rows([{**row, **(estimator.statistic(source) or {})}])


@pytest.mark.parametrize("estimator", ALL, ids=_name)
def test_a_measured_sample_and_a_simulated_one_have_the_same_terms(estimator):
    """The object is one, and so are its numbers; likelihoods on file are rounded."""
    source = source_facet()
    simulated = Sample.from_rows([observe(estimator, source)])
    measured = _measured(estimator, source)
    ours, theirs = (sky_terms(estimator, sample, 0.01 - 0.02j) for sample in (simulated, measured))
    assert ours.tells.all()
    if isinstance(estimator, Bayesian):
        # the rounding of packed likelihoods; without a galaxy's own scale a tolerance would say nothing
        scale = np.sqrt(np.trace(ours.response[0]) / 2)
        np.testing.assert_allclose(theirs.value, ours.value, rtol=0, atol=3e-3 * scale)
        np.testing.assert_allclose(theirs.response, ours.response, rtol=0, atol=5e-3 * scale**2)
    else:
        np.testing.assert_array_equal(theirs.value, ours.value)
        np.testing.assert_array_equal(theirs.response, ours.response)


@pytest.mark.parametrize("estimator", [Moments, Metacal, Bayesian], ids=lambda cls: cls.name)
def test_what_is_prepared_for_one_source_serves_others_of_another_unit_of_flux(estimator):
    """A source whose spectral index is its own has a facet in a unit of its own."""
    source, shared = source_facet(), estimator()
    other_unit = in_other_unit(source, 1.3)
    shared.statistic(source)
    again, fresh = shared.statistic(other_unit), estimator().statistic(other_unit)
    for name, value in fresh.items():
        scale = np.abs(np.asarray(value)).max() + 1e-12
        np.testing.assert_allclose(again[name], value, atol=1e-5 * scale)


@pytest.mark.parametrize("estimator", [Moments(), Metacal(), Bayesian()], ids=_name)
def test_a_statistic_has_the_columns_that_it_announces(estimator):
    kept = estimator.statistic(source_facet())
    assert list(kept) == list(estimator.columns)
    assert all(column.description for column in estimator.columns.values())


def test_a_row_has_the_shape_only_where_it_is_needed():
    source = source_facet()
    assert "e1" not in observe(Moments(), source)
    row = observe(Shapes(), source)
    assert {"flux", "e1", "e2", "snr", "weight"} <= set(row)
    assert row["flux"] == source.flux
    assert row["e1"] == source.shape.ellipticity[0]


def test_a_source_whose_shape_fails_has_no_row_of_an_estimator_that_needs_it():
    empty = source_facet(flux=-5e-5, noise=0.1)
    assert empty.shape.flag is not FitFlag.OK
    assert observe(Mean(), empty) is None
    assert observe(Moments(), empty) is not None


def test_an_estimator_that_says_no_more_is_a_plain_ratio():
    shapes = Shapes()
    assert not shapes.is_expanded
    assert not shapes.is_learning
    assert shapes.learner is shapes
    assert shapes.trained(Sample({}, np.zeros(0)), 0j) is shapes
    assert shapes.statistic(source_facet()) == {}
    assert shapes.record() == {}
    assert shapes.remark == ""
