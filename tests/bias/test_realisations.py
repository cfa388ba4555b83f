"""Realisations in whose average shapes and noise cancel."""

from dataclasses import replace

import numpy as np

from uvshear.bias.isolated import Experiment
from uvshear.bias.realisations import OPPOSITE, TURNED
from uvshear.constants import ARCSEC
from uvshear.estimators.estimator import observe
from uvshear.estimators.mean import Mean
from uvshear.estimators.sample import Sample
from uvshear.galaxy import DiscEllipticityPrior, Exponential
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.source_facet import SourceFacet

PRIOR = ShapePrior(np.log(1.0 * ARCSEC), 0.3)


def _mean_terms(simulator, realisations, galaxies, noise):
    """Terms of the mean for one galaxy, in every realisation."""
    rows = []
    for realisation in realisations:
        seen = realisation.galaxies(galaxies)
        galaxy = GalaxyFit(2e-5, np.zeros(2), complex(seen.ellipticity[0]), 5e-6, 0.0)
        facet = simulator.facet(galaxy, Exponential(), realisation.noise(simulator, noise))
        source = SourceFacet(
            facet,
            simulator.cutout,
            PRIOR,
            2e-5,
            Exponential(),
            DiscEllipticityPrior(),
            draw_noise=lambda seed: noise,
        )
        rows.append(observe(Mean(), source))
    return Mean().terms(Sample.from_rows(rows), np.zeros(len(rows), complex)).value


def test_a_turned_sky_cancels_all_but_the_beams_own_direction(beam):
    """Of a beam that a turn does not change nothing is left, not even of one galaxy with its noise."""
    simulator = beam.simulator(np.log(1.0 * ARCSEC), 0.3)
    turned_power = simulator.turned(simulator.power.astype(complex)).real
    same = replace(simulator, power=(simulator.power + turned_power) / 2)
    noise = simulator.draw_noise(np.random.default_rng(2))
    galaxies = Experiment(beam, (0j,)).draw(1, np.random.default_rng(3))

    def left(which, realisations):
        terms = _mean_terms(which, realisations, galaxies, noise)
        return np.abs(np.sum(terms, axis=0)).max() / np.abs(terms).max()

    assert len(TURNED) == 8
    # measured 4e-3, of the posterior's lattice; 0.5 of the real beam
    assert left(same, TURNED) < 8e-3
    assert left(simulator, TURNED) > 20 * left(same, TURNED)
    # shapes and noise of both signs alone leave the second order of the noise: 0.4
    assert left(same, OPPOSITE) > 0.1


def test_opposite_realisations_have_both_signs_of_shapes_and_of_noise(beam):
    simulator = beam.simulator(np.log(1.0 * ARCSEC), 0.3)
    noise = simulator.draw_noise(np.random.default_rng(2))
    galaxies = Experiment(beam, (0j,)).draw(1, np.random.default_rng(3))
    signs = {
        (
            float((part.galaxies(galaxies).ellipticity / galaxies.ellipticity)[0].real),
            float((part.noise(simulator, noise) / noise)[0].real),
        )
        for part in OPPOSITE
    }
    assert signs == {(1, 1), (1, -1), (-1, 1), (-1, -1)}


def test_a_turn_takes_positions_along(beam):
    galaxies = replace(
        Experiment(beam, (0j,)).draw(1, np.random.default_rng(3)),
        l=np.array([1e-6]),
        m=np.array([3e-6]),
    )
    turned = TURNED[4].galaxies(galaxies)
    # from l towards m
    assert (turned.l[0], turned.m[0]) == (-3e-6, 1e-6)
    np.testing.assert_array_equal(turned.ellipticity, -galaxies.ellipticity)
