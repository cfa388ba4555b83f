"""Modes besides the best fit, without noise where the answer is known."""

from dataclasses import replace

import numpy as np

from tests.shapes.facets import ALPHA, EXPONENTIAL, PRIOR, noise_free
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.maximum import maximise_likelihood
from uvshear.shapes.posterior_modes import PosteriorModes

WIDE = replace(PRIOR, position_radius=6 * ALPHA)


def _modes(facet):
    correlator = Correlator(facet, EXPONENTIAL)
    best = maximise_likelihood(correlator, WIDE)
    return PosteriorModes.from_lattices(correlator, WIDE, best), best, correlator


def test_the_best_fit_is_among_the_modes():
    modes, best, _ = _modes(noise_free(0.2 + 0.1j, snr=15.0)[0])
    assert np.hypot(*modes.positions.T).min() == 0
    assert best.ellipticity in modes.ellipticity
    assert best.log_scale_length in modes.log_scale_length


def test_two_sources_of_one_flux_are_two_modes():
    first, second = (noise_free(l=l, snr=9.0)[0] for l in (-2 * ALPHA, 2 * ALPHA))
    both = replace(first, correlation=first.correlation + second.correlation)
    modes, best, correlator = _modes(both)
    x = (modes.positions[:, 0] + best.position[0]) * correlator.length
    assert x.min() < -1.5 * ALPHA
    assert x.max() > 1.5 * ALPHA


def test_a_brighter_galaxy_has_fewer_likely_shapes_nearer_to_the_best_fit():
    faint, bright = (_modes(noise_free(snr=snr)[0])[0] for snr in (6.0, 18.0))
    assert len(bright.ellipticity) < len(faint.ellipticity)
    assert np.hypot(*bright.positions.T).max() < np.hypot(*faint.positions.T).max()
    assert bright.sigma < faint.sigma
