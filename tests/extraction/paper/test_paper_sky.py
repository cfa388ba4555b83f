"""The sky of the paper's extraction, handed from fit to fit."""

import numpy as np
import pytest

from tests.extraction.fields import field_of, pair
from uvshear.extraction.paper.paper_sky import PaperSky
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import GalaxyFit

FIT = GalaxyFit(3e-3, np.array([1e-6, -1e-6]), 0.2j, 1e-5, 50.0)


@pytest.fixture(scope="module")
def field():
    observation, catalogue, _ = pair()
    return field_of(observation, catalogue)


def test_good_fits_replace_circles_and_nothing_else_changes(field):
    begun = PaperSky(field.sky)
    after = begun.with_fits(field, [0, 1], [None, FIT])
    assert after.sky.ellipticity.tolist() == [0, 0.2j]
    assert after.sky.flux.tolist() == [field.sky.flux[0], 3e-3]
    assert after.sky.l[1] == field.l[1] + 1e-6
    assert dict(after.fits) == {1: FIT}
    assert begun.sky is field.sky
    assert not begun.fits


def test_a_source_that_is_looked_for_from_scratch_stays_in_the_sky(field):
    fitted = PaperSky(field.sky).with_fits(field, [0, 1], [FIT, FIT])
    afresh = fitted.without_starts([1])
    assert list(afresh.fits) == [0]
    assert afresh.sky is fitted.sky
    assert list(fitted.fits) == [0, 1]


def test_every_major_cycle_is_counted_and_its_power_remembered(field):
    power = np.ones(3)
    facet = Facet(np.zeros((3, 2)), np.zeros(3, complex), power)
    after = PaperSky(field.sky).with_facets([1], [facet])
    assert after.major_cycles == 1
    assert after.power[1].dtype == np.float32
    assert after.with_facets([0], [facet]).major_cycles == 2
    assert sorted(after.with_facets([0], [facet]).power) == [0, 1]
