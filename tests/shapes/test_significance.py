"""Significance of a source and of its extent, against likelihoods by direct sums over the cells."""

import math

import numpy as np
import pytest

from tests.reference import plane
from uvshear.galaxy import Exponential
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import FitFlag, GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.significance import Significance, significance_of

RNG = np.random.default_rng(2)
UV = RNG.uniform(-4e4, 4e4, (800, 2))
POWER = RNG.uniform(1e8, 3e8, 800)
ALPHA = 4e-6
PRIOR = ShapePrior(math.log(ALPHA), 0.3)
PROFILE = Exponential()


def _visibilities(flux, offset, e, alpha):
    if alpha == 0:
        return flux * np.exp(2j * np.pi * UV @ np.asarray(offset))
    return plane.galaxy(UV, flux, offset, e, alpha)


def _facet(vis, noise=0.0):
    drawn = RNG.standard_normal(800) + 1j * RNG.standard_normal(800)
    return Facet(UV, POWER * vis + noise * np.sqrt(POWER) * drawn, POWER)


def _log_likelihood(facet, vis):
    return float(np.sum((facet.correlation * vis.conj()).real - facet.power * np.abs(vis) ** 2 / 2))


def test_both_significances_are_those_of_direct_sums():
    truth = (3e-5, (1e-6, -2e-6), 0.3 - 0.2j, ALPHA)
    facet = _facet(_visibilities(*truth))
    fit = GalaxyFit(truth[0], np.array(truth[1]), truth[2], ALPHA, 1.0)
    found = significance_of(facet, PRIOR, PROFILE, fit)
    galaxy = _log_likelihood(facet, _visibilities(*truth))
    assert found.detection == pytest.approx(math.sqrt(2 * galaxy), rel=1e-4)
    # A direct search for the best point.
    grid = np.linspace(-6e-6, 6e-6, 61)
    best = 0.0
    for x in grid:
        for y in grid:
            phase = _visibilities(1.0, (x, y), 0, 0)
            height = float(np.sum((facet.correlation * phase.conj()).real))
            best = max(best, height**2 / (2 * float(POWER.sum())))
    assert found.resolved == pytest.approx(math.sqrt(2 * (galaxy - best)), rel=1e-3)
    halved = significance_of(facet, PRIOR, PROFILE, fit, fraction=0.25)
    assert halved.detection == pytest.approx(found.detection / 2)
    assert halved.resolved == pytest.approx(found.resolved / 2)


def test_a_point_is_not_resolved():
    facet = _facet(_visibilities(3e-5, (0.0, 0.0), 0, 0))
    fit = GalaxyFit(3e-5, np.zeros(2), 0j, 0.2 * ALPHA, 1.0)
    found = significance_of(facet, PRIOR, PROFILE, fit)
    assert found.resolved == 0
    assert found.detection > 10
    assert found.flag is FitFlag.UNRESOLVED


def test_flags_by_significance():
    assert Significance(4.9, 10.0).flag is FitFlag.NOT_DETECTED
    assert Significance(5.1, 3.9).flag is FitFlag.UNRESOLVED
    assert Significance(5.1, 4.1).flag is FitFlag.OK
