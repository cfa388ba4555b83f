"""Estimators by name, as classes and as objects."""

import inspect
from dataclasses import dataclass
from importlib.metadata import EntryPoint

import pytest

import uvshear.plugins
from tests.estimators.test_estimator import Shapes
from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.mean import Mean
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.estimators.registry import ESTIMATORS, configured, estimator_of, estimators_of
from uvshear.estimators.sample import Sample


@pytest.mark.parametrize(
    ("name", "cls"),
    [("mean", Mean), ("moments", Moments), ("bayesian", Bayesian), ("metacal", Metacal)],
)
def test_the_packages_own_are_found_by_name(name, cls):
    found = estimator_of(name)
    assert type(found) is cls
    assert found.name == name
    assert name in ESTIMATORS.names()


def test_the_name_of_an_older_release_is_known():
    """`--keep likelihood` is that of 0.1.0."""
    assert isinstance(estimator_of("likelihood"), Bayesian)
    assert "likelihood" not in ESTIMATORS.names()


def test_classes_become_objects_and_objects_stay():
    own = Moments(1e-6)
    assert estimator_of(own) is own
    assert estimator_of(Moments) == Moments()


def test_module_and_name_are_imported():
    assert isinstance(estimator_of("tests.estimators.test_estimator:Shapes"), Shapes)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            "median",
            "'median' is not a known estimator; the known names are mean, moments, bayesian, metacal,",
        ),
        ("", "'' is not a known estimator"),
        ("no_such_file:Median", "'no_such_file:Median' cannot be imported: No module named"),
        ("uvshear.estimators:Median", "cannot be imported: module 'uvshear.estimators' has no"),
        ("uvshear.estimators:", "cannot be imported"),
        ("uvshear.estimators:ESTIMATORS", "is not an estimator of the shear; a name (mean, "),
    ],
)
def test_what_is_no_estimator_is_refused_in_one_line(given, message):
    with pytest.raises(InputError) as error:
        estimator_of(given)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("given", [3, None, dict, Sample])
def test_objects_of_another_kind_are_refused_in_one_line(given):
    # without the tests' own check of types
    with pytest.raises(InputError, match="is not an estimator of the shear; a name"):
        inspect.unwrap(estimator_of)(given)


def test_several_are_given_by_commas_or_in_a_sequence():
    assert [e.name for e in estimators_of("moments, bayesian")] == ["moments", "bayesian"]
    own = Moments(1e-6)
    assert estimators_of([own, "mean", Metacal]) == (own, Mean(), Metacal())
    assert estimators_of(own) == (own,)
    assert estimators_of(Mean) == (Mean(),)
    assert estimators_of(()) == ()


def test_each_name_counts_once():
    own = Moments(1e-6)
    assert estimators_of([own, "moments"]) == (own,)
    assert [e.name for e in estimators_of("likelihood,bayesian")] == ["bayesian"]


@pytest.fixture
def registered(monkeypatch):
    """Two entry points: one of its own name, and one that would take the place of the package's."""
    group = "uvshear.estimators"
    points = [
        EntryPoint("shapes", "tests.estimators.test_estimator:Shapes", group),
        EntryPoint("mean", "tests.estimators.test_estimator:Shapes", group),
    ]
    monkeypatch.setattr(
        uvshear.plugins, "entry_points", lambda *, group: [p for p in points if p.group == group]
    )


def test_entry_points_are_known_by_name(registered):
    assert isinstance(estimator_of("shapes"), Shapes)
    assert ESTIMATORS.names() == ("mean", "moments", "bayesian", "metacal", "shapes")


def test_entry_points_do_not_take_the_place_of_the_packages_own(registered):
    assert isinstance(estimator_of("mean"), Mean)


def test_fields_of_an_estimator_are_configured():
    assert configured(Moments(), asked={"position_sigma": 1e-6}) == Moments(1e-6)
    assert configured(Metacal(), offered={"seed": 7, "position_sigma": 1e-6}) == Metacal(seed=7)
    own = Moments()
    assert configured(own) is own


def test_a_field_that_was_asked_for_and_is_not_there_is_told():
    with pytest.raises(InputError, match="the estimator 'mean' has no setting 'position_sigma'"):
        configured(Mean(), asked={"position_sigma": 1e-6})


def test_an_estimator_that_is_no_dataclass_has_no_fields():
    class Plain(Shapes.__base__):
        name = "plain"

        def terms(self, sample, about):
            raise NotImplementedError

    plain = Plain()
    assert configured(plain, offered={"seed": 3}) is plain
    with pytest.raises(InputError, match="'plain' has no setting 'seed'"):
        configured(plain, asked={"seed": 3})


def test_fields_with_a_default_of_the_class_are_configured():
    @dataclass(frozen=True)
    class Own(Metacal):
        limit: float = 0.5

    assert configured(Own(), offered={"seed": 2}).seed == 2
