"""Modelled sources: fits, steps, and priors that are released."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.sources import ALPHA, PROFILE, scene
from uvshear.extraction.converged.sources import RELEASE, GalaxySource, PointSource
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior

EXPECTED = GalaxyFit(1e-4, np.zeros(2), 0j, ALPHA, 0.0)
PRIOR = ShapePrior(float(np.log(ALPHA)), 0.3, ellipticity_sigma=0.3, position_sigma=0.3 * ALPHA)


@pytest.fixture(scope="module")
def facet():
    field = scene(e=0.3 - 0.2j, flux=1e-4)
    return field.facet(ExactFacets(), field.galaxy)


@pytest.fixture
def source():
    return GalaxySource(PRIOR, PROFILE, EXPECTED)


def test_a_galaxy_is_found_from_scratch_and_from_a_start(source, facet):
    found = source.refit(facet, (None,))
    assert found.ellipticity == pytest.approx(0.3 - 0.2j, abs=0.01)
    again = source.refit(facet, (None, found))
    assert again.ellipticity == pytest.approx(found.ellipticity, abs=1e-3)


def test_where_no_fit_is_found_the_expected_source_takes_its_best_flux(source, facet):
    negative = replace(facet, correlation=-facet.correlation)
    assert source.refit(negative, (None,)).flux == 0
    moved = replace(source, prior=replace(PRIOR, position_radius=1e-12))
    fallback = replace(moved, expected=replace(EXPECTED, offset=np.zeros(2))).refit(
        negative, (None,)
    )
    assert fallback.snr == 0
    assert fallback.scale_length == ALPHA


def test_a_point_has_no_size(facet):
    point = PointSource(PRIOR, PROFILE, replace(EXPECTED, scale_length=0.0))
    found = point.refit(facet, (None,))
    assert found.scale_length == 0
    assert found.flux > 0


def test_a_released_source_has_next_to_no_prior_on_its_ellipticity(source):
    released = source.released()
    assert released.prior.ellipticity_sigma == RELEASE * 0.3
    assert released.prior.position_sigma == PRIOR.position_sigma
    assert source.prior is PRIOR


def test_steps_are_no_longer_than_can_be_believed(source):
    fit = replace(EXPECTED, snr=10.0)
    short = source.after_step(fit, np.array([1e-5, 0.1, -0.1, 0.1, 0.0, 0.0]))
    assert short.flux == pytest.approx(1.1e-4)
    assert short.ellipticity == pytest.approx(0.1 - 0.1j)
    assert short.snr == pytest.approx(11.0)
    long = source.after_step(fit, np.array([0.0, 3.0, 0.0, 1.0, 0.0, 0.0]))
    assert long.ellipticity == pytest.approx(0.3)
    assert long.scale_length == pytest.approx(ALPHA * np.exp(0.1))
    nothing = replace(fit, flux=0.0)
    assert source.after_step(nothing, np.ones(6)) is nothing


def test_a_model_is_that_of_the_facet_without_noise(source, facet):
    true = GalaxyFit(1e-4, np.zeros(2), 0.3 - 0.2j, ALPHA, 1.0)
    model = facet.power * source.model(true, facet.uv)
    error = np.linalg.norm(facet.correlation - model)
    assert error < 1e-4 * np.linalg.norm(model)
