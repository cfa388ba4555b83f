"""Widths of facets, pixels, and the rough major cycles."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.states import touching_pair
from tests.extraction.fields import field_of
from tests.skies import galaxies, vla
from uvshear.constants import ARCMIN, ARCSEC
from uvshear.extraction import MeasurementOptions
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.beams import SIZE
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.planner import POINT_STAMP, WIDEST, Planner
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.shapes.measurement import FitFlag


@pytest.fixture(scope="module")
def planner():
    return touching_pair().planner


def _width(plan, source):
    return plan.cutouts[source].size * plan.pixel


def test_facets_are_so_many_scale_lengths_wide(planner):
    plan = planner.plan(planner.modelled.expected)
    assert plan.pixel == pytest.approx(planner.pixel)
    for source in (0, 1):
        least = 45 * planner.modelled.median_size[source]
        assert least <= _width(plan, source) * (1 + 1e-9)
        assert _width(plan, source) < 1.5 * least


def test_a_galaxy_that_was_found_to_be_larger_has_a_wider_facet(planner):
    expected = planner.modelled.expected
    larger = replace(expected[0], scale_length=4 * expected[0].scale_length, snr=1000.0)
    usual, wider = planner.plan(expected), planner.plan([larger, expected[1]])
    assert _width(wider, 0) > 1.2 * _width(usual, 0)
    assert _width(wider, 1) == _width(usual, 1)
    huge = replace(larger, scale_length=100 * ARCSEC)
    widest = _width(planner.plan([huge, expected[1]]), 0)
    assert widest < 1.2 * WIDEST * SIZE * planner.pixel


def test_points_have_the_narrowest_facet_and_a_stamp_of_their_own(planner):
    modelled = planner.modelled
    flags = modelled.field.flags.copy()
    flags[1] = FitFlag.POINT_SOURCE
    with_point = replace(modelled, field=replace(modelled.field, flags=flags))
    some = replace(planner, modelled=with_point)
    plan = some.plan(modelled.expected)
    assert _width(plan, 1) == _width(plan, 0)
    sky = some.subtracted(modelled.expected)
    assert sky.half_width[1] == pytest.approx(POINT_STAMP / 2 * some.pixel)
    assert sky.half_width[0] == pytest.approx(45 / 2 * modelled.median_size[0])


def test_a_rough_cycle_leaves_out_the_longest_baselines_of_a_wide_field(planner):
    uvw, centre = vla("b", samples=2)
    weights = np.ones((len(uvw), 1))
    seen = Visibilities(uvw, np.array([1.4e9]), weights.astype(complex), weights)
    sky = galaxies(l=np.array([-25.0, 25.0]) * ARCMIN, flux=1e-3, alpha=6 * ARCSEC)
    observation = VisibilitySet(centre, (seen,))
    options = MeasurementOptions()
    field = field_of(observation, catalogue_from_galaxies(sky, centre), options)
    modelled = ModelledField.from_field(field, options.model, centre.dec)
    wide = Planner(modelled, Baselines.from_field(field, modelled.is_galaxy, None), 45.0)
    plan, rough = wide.plan(modelled.expected), wide.plan_roughly(modelled.expected)
    assert plan.has_all_baselines
    assert not rough.has_all_baselines
    assert rough.longest < 0.5 * plan.longest
    assert rough.pixel == plan.pixel
    # A narrow field has one band.
    narrow = planner.modelled.expected
    assert planner.plan_roughly(narrow).longest == planner.plan(narrow).longest


def test_the_beams_have_the_pixels_and_the_baselines_of_the_facets(planner):
    beams, plan = planner.plan_beams(), planner.plan(planner.modelled.expected)
    assert beams.pixel == plan.pixel
    assert (beams.shortest, beams.longest) == (plan.shortest, plan.longest)
    assert len(beams.mixtures) == 2
