"""Whatever is in a set and in a catalogue: an error in one line, or a table whose every ``ok`` is earned."""

import json
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from tests.pipeline.wild_inputs import catalogue, observation, wild_catalogues, wild_sets
from uvshear.constants import ARCSEC
from uvshear.errors import DataWarning, InputError
from uvshear.extraction import Method, Model
from uvshear.extraction.paper import PaperExtraction
from uvshear.galaxy import CatalogueSize
from uvshear.pipeline.measure import measure

wildly = settings(
    deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow], database=None
)
ERRORS = ("e1_err", "e2_err", "e_sigma", "scale_length_err", "flux_fit_err", "snr", "weight")


def assert_honest(shapes):
    numbers = [name for name in shapes.colnames if shapes[name].dtype.kind == "f"]
    # The paper's extraction makes one pass, and cannot tell what another would change.
    if json.loads(shapes.meta["extract"])["extraction"] == "paper":
        numbers.remove("remaining_change")
    is_ok = np.asarray(shapes["flag"]) == "ok"
    # A source that is alone is infinitely far from others.
    numbers.remove("neighbour_distance")
    assert (np.asarray(shapes["neighbour_distance"])[is_ok] > 0).all()
    for name in numbers:
        assert np.isfinite(np.asarray(shapes[name])[is_ok]).all(), name
    for name in ERRORS:
        assert (np.asarray(shapes[name])[is_ok] > 0).all(), name
    assert not np.asarray(shapes["weight"])[~is_ok].any()
    e = np.hypot(shapes["e1"], shapes["e2"])
    assert not (np.asarray(e) >= 1).any()


def measured(seen, sources, method, model):
    """The shapes, or None where the input is refused in a line; a warning other than of data is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)
        try:
            return measure(seen, sources, method=method, model=model).shapes
        except InputError as error:
            refusal = str(error)
    assert "\n" not in refusal
    return None


@settings(wildly, max_examples=14)
@given(wild_sets, wild_catalogues)
def test_the_converged_extraction_returns_nothing_that_is_not_so(of_set, of_catalogue):
    model = Model(size=CatalogueSize()) if len(of_set) == 1 else Model()
    shapes = measured(observation(of_set), catalogue(of_catalogue), Method(), model)
    if shapes is not None:
        assert_honest(shapes)


@settings(wildly, max_examples=10)
@given(wild_sets, wild_catalogues)
def test_the_papers_extraction_returns_nothing_that_is_not_so(of_set, of_catalogue):
    method = Method(extraction=PaperExtraction())
    shapes = measured(observation(of_set), catalogue(of_catalogue), method, Model())
    if shapes is not None:
        assert_honest(shapes)


def test_what_is_measured_without_wild_values_is_all_there():
    """The other tests would pass if everything were refused."""
    shapes = measured(observation([]), catalogue([]), Method(), Model(size=CatalogueSize()))
    assert set(shapes["flag"]) == {"ok"}
    assert_honest(shapes)
    shapes["flux_fit_err"][2] = 0.0
    with pytest.raises(AssertionError, match="flux_fit_err"):
        assert_honest(shapes)


def test_two_sources_of_one_pixel_and_a_giant_are_honest():
    table = catalogue([])
    table["ra"][1] = table["ra"][0] + np.degrees(0.3 * ARCSEC)
    table["dec"][1] = table["dec"][0]
    table["scale_length"][2] = 300.0
    for method in (Method(), Method(extraction=PaperExtraction())):
        assert_honest(measured(observation([]), table, method, Model(size=CatalogueSize())))
