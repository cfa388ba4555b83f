from dataclasses import replace

import numpy as np
import pytest

from tests.shapes.facets import ALPHA, PRIOR, samples
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.point import Point, fit_point

OFFSET = np.array([0.3, -0.2]) * ALPHA
WITHIN = replace(PRIOR, position_radius=ALPHA)


def _facet(flux=1e-4, offset=OFFSET, rng=None):
    uv, weights = samples()
    correlation = weights * flux * np.exp(2j * np.pi * uv @ offset)
    if rng is not None:
        noise = rng.normal(size=(2, len(uv)))
        correlation = correlation + np.sqrt(weights) * (noise[0] + 1j * noise[1])
    return Facet(uv, correlation, weights)


@pytest.mark.parametrize("prior", [PRIOR, WITHIN])
def test_a_point_source_without_noise_is_found_where_it_is(prior):
    fit = fit_point(_facet(), prior)
    assert fit is not None
    # measured 1e-9, 2e-7: steps end at 1e-4 of the error
    assert fit.flux == pytest.approx(1e-4, rel=1e-6)
    np.testing.assert_allclose(fit.offset, OFFSET, rtol=0, atol=1e-5 * ALPHA)
    assert fit.scale_length == 0
    assert fit.ellipticity == 0
    assert fit.snr == pytest.approx(1e-4 * np.sqrt(samples()[1].sum()), rel=1e-6)


def test_a_start_leads_to_the_same_place():
    start = GalaxyFit(1e-5, OFFSET + 0.3 * ALPHA, 0j, 0.0, 1.0)
    found = fit_point(_facet(), WITHIN, start)
    afresh = fit_point(_facet(), WITHIN)
    assert found is not None
    assert afresh is not None
    np.testing.assert_allclose(found.offset, afresh.offset, rtol=0, atol=1e-5 * ALPHA)


def test_fluxes_and_places_scatter_as_the_fisher_matrix_says():
    uv, weights = samples()
    flux = 20 / np.sqrt(weights.sum())
    rng = np.random.default_rng(1)
    fits = [fit_point(_facet(flux, rng=rng), WITHIN) for _ in range(200)]
    assert all(fits)
    values = np.array([[fit.flux, *fit.offset] for fit in fits])
    information = np.zeros((3, 3))
    information[0, 0] = weights.sum()
    information[1:, 1:] = (2 * np.pi * flux) ** 2 * (uv.T * weights) @ uv
    error = np.sqrt(np.diag(np.linalg.inv(information)))
    pulls = (values - [flux, *OFFSET]) / error
    assert np.all(np.abs(pulls.mean(axis=0)) < 3 / np.sqrt(200))
    # the standard deviation of a width of 200 draws is 0.05
    np.testing.assert_allclose(pulls.std(axis=0), 1, rtol=0, atol=0.15)


@pytest.mark.parametrize("prior", [PRIOR, WITHIN])
def test_the_negative_of_a_source_is_none(prior):
    assert (
        fit_point(_facet(-1e-4, np.zeros(2)), replace(prior, position_radius=0.05 * ALPHA)) is None
    )


def test_a_source_beyond_the_prior_on_the_position_is_none():
    start = GalaxyFit(1e-4, 1.2 * OFFSET * 8, 0j, 0.0, 1.0)
    assert fit_point(_facet(offset=8 * OFFSET), WITHIN, start) is None


def test_cells_without_weight_hold_no_source():
    facet = _facet()
    assert fit_point(Facet(facet.uv, 0 * facet.correlation, 0 * facet.power), PRIOR) is None
    empty = Facet(facet.uv[:0], facet.correlation[:0], facet.power[:0])
    assert fit_point(empty, PRIOR) is None


def test_the_profile_of_a_point_is_one_and_its_slope_zero():
    q = np.linspace(0, 30, 7)
    np.testing.assert_array_equal(Point().envelope(q), np.ones(7))
    np.testing.assert_array_equal(Point().envelope_slope(q), np.zeros(7))
