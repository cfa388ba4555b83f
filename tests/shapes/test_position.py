"""Flux and position integrated out, against brute force over a square of positions."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import log_ndtr
from scipy.stats import truncnorm

from tests.shapes.facets import ALPHA, EXPONENTIAL, PRIOR, noise_free
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.maximum import maximise_likelihood, search_radius
from uvshear.shapes.position import PositionQuadrature, _positive_flux
from uvshear.shapes.posterior_modes import PosteriorModes

WIDE = replace(PRIOR, position_radius=3 * ALPHA)
SHAPES = np.array([0.25 + 0.1j, 0.1 + 0j, 0.4 - 0.1j]), np.log(ALPHA) + np.array([0.0, 0.1, -0.1])


def _brute_force(correlator, radius, best):
    axis = np.linspace(-radius, radius, 121)
    nodes = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2) - best.position
    nodes = nodes[np.hypot(*(nodes + best.position).T) <= radius]
    heights, norm = correlator.correlate(*SHAPES, correlator.displaced_to(nodes))
    significance = heights / np.sqrt(norm)[:, None]
    terms = 0.5 * significance**2 + log_ndtr(significance) - 0.5 * np.log(norm)[:, None]
    weight = np.exp(terms - terms.max())
    offset = (weight @ nodes) / weight.sum(axis=1)[:, None]
    return np.log(weight.sum(axis=1)), offset


@pytest.mark.parametrize(("snr", "allowed"), [(40.0, 0.01), (9.0, 0.02)])
def test_differences_of_log_likelihood_are_those_of_brute_force(snr, allowed):
    facet, _ = noise_free(0.2 + 0.1j, snr=snr)
    correlator = Correlator(facet, EXPONENTIAL)
    best = maximise_likelihood(correlator, WIDE)
    radius = search_radius(correlator, WIDE)
    if snr > 20:
        quadrature = PositionQuadrature.from_best_fit(correlator, best, radius)
    else:
        modes = PosteriorModes.from_lattices(correlator, WIDE, best)
        quadrature = PositionQuadrature.from_modes(correlator, modes)
    marginal = quadrature.marginalise(*SHAPES)
    expected, offset = _brute_force(correlator, radius, best)
    got = marginal.log_likelihood - marginal.log_likelihood[0]
    np.testing.assert_allclose(got, expected - expected[0], rtol=0, atol=allowed)
    sigma = np.sqrt(marginal.offset_variance)
    assert np.all(np.abs(marginal.offset - offset) < 0.05 * sigma)


def test_a_template_out_of_reach_has_no_likelihood():
    facet, _ = noise_free(snr=40.0)
    correlator = Correlator(facet, EXPONENTIAL)
    best = maximise_likelihood(correlator, WIDE)
    quadrature = PositionQuadrature.from_best_fit(correlator, best, 10.0)
    marginal = quadrature.marginalise(np.zeros(2, complex), np.log(ALPHA) + np.array([0.0, 60.0]))
    assert np.isfinite(marginal.log_likelihood[0])
    assert marginal.log_likelihood[1] == -np.inf


@pytest.mark.parametrize("significance", [-300.0, -8.0, -1.0, 0.0, 2.0, 30.0])
def test_fluxes_are_those_of_a_truncated_normal(significance):
    mean, variance = _positive_flux(np.array([[significance]]))
    if significance > -30:
        reference = truncnorm(-significance, np.inf, loc=significance)
        assert mean[0, 0] == pytest.approx(reference.mean(), rel=1e-6)
        assert variance[0, 0] == pytest.approx(reference.var(), rel=1e-4)
    else:  # an exponential
        assert mean[0, 0] == pytest.approx(-1 / significance, rel=1e-3)


def test_a_likely_position_between_the_points_of_the_lattice_is_a_node():
    """The best fit, where the lattice has a point, is none of the likely positions of a fit that found no peak."""
    facet, _ = noise_free(0.2 + 0.1j, snr=9.0)
    correlator = Correlator(facet, EXPONENTIAL)
    maximise_likelihood(correlator, WIDE)
    alone = PosteriorModes(np.array([[0.7, 0.0]]), 0.05, 1.0, *(x[:1] for x in SHAPES))
    marginal = PositionQuadrature.from_modes(correlator, alone).marginalise(*SHAPES)
    assert np.isfinite(marginal.log_likelihood).all()
    np.testing.assert_allclose(marginal.offset, np.tile([0.7, 0.0], (3, 1)))
