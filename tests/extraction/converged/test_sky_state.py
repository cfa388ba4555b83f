"""The facets of a sky, and distances between skies."""

from dataclasses import replace

import numpy as np
import pytest

from tests.extraction.converged.states import prepare, touching_pair
from tests.extraction.fields import FREQUENCY, OPTIONS
from tests.skies import galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.predict import predict_visibilities
from uvshear.shapes.shape import fit_galaxy


@pytest.fixture(scope="module")
def prepared():
    return touching_pair()


def test_a_facet_is_the_residual_with_the_sources_own_model(prepared):
    state = prepared.state
    for k in (0, 1):
        facet, residual = state.facet(k), state.residual(k)
        own = facet.power * state.sources[k].model(state.fits[k], facet.uv)
        error = np.linalg.norm(facet.correlation - residual.correlation - own)
        assert error < 1e-5 * np.linalg.norm(own)


def test_a_galaxy_alone_is_found_in_its_facet():
    uvw, centre = vla("b", samples=4)
    truth = galaxies(flux=2e-3, alpha=2.2 * ARCSEC, e=0.4 + 0.2j)
    vis = predict_visibilities(truth, uvw, FREQUENCY)
    observation = VisibilitySet(
        centre, (Visibilities(uvw, FREQUENCY, vis, np.full(vis.shape, 1e8)),)
    )
    state = prepare(observation, catalogue_from_galaxies(truth, centre), truth, OPTIONS).state
    source = state.sources[0]
    fit = fit_galaxy(state.facet(0), source.prior.measured, source.profile)
    assert fit.ellipticity == pytest.approx(0.4 + 0.2j, abs=3e-3)
    assert fit.flux == pytest.approx(2e-3, rel=3e-3)


def test_a_change_is_told_in_units_of_the_noise(prepared):
    state = prepared.state
    brighter = replace(state.fits[0], flux=1.1 * state.fits[0].flux)
    changed = replace(state, fits=(brighter, state.fits[1]))
    facet = state.facet(0)
    model = state.sources[0].model(state.fits[0], facet.uv)
    expected = 0.1 * np.sqrt(np.sum(facet.power * np.abs(model) ** 2))
    assert changed.change_of_unit([0], state.fits) == pytest.approx(expected, rel=1e-4)
    assert changed.change_of_unit([1], state.fits) == 0


def test_sources_of_a_group_may_trade_what_the_data_cannot_tell_apart(prepared):
    state = prepared.state
    more, less = (
        replace(fit, flux=fit.flux * factor)
        for fit, factor in zip(state.fits, (1.1, 0.9), strict=True)
    )
    changed = replace(state, fits=(more, less))
    alone = [changed.change_of_unit([k], state.fits) for k in (0, 1)]
    assert changed.change_of_unit([0, 1], state.fits) < np.hypot(*alone)
