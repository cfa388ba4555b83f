"""Cell averages that are drawn, against those of the paper's extraction."""

from dataclasses import replace

import numpy as np
import pytest

from tests.bias.surveys import SHEARS, one_galaxy, plan
from uvshear.bias.cell_average import LADDER, SMALLEST, CellAverageBeam, ScaleLengthCount
from uvshear.bias.survey import Survey
from uvshear.constants import ARCSEC, MICROJANSKY
from uvshear.extraction.paper.cell_average import CellAverageFacets
from uvshear.extraction.paper.facets import Target
from uvshear.galaxy import Exponential
from uvshear.interferometer.uv_range import UvRange
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline.simulate import simulate
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior

ALPHA = 1.5 * ARCSEC


@pytest.fixture(scope="module")
def cells():
    return Survey(plan(), averages_cells=True).isolated(SHEARS).beam


@pytest.fixture(scope="module")
def simulator(cells):
    return cells.simulator(float(np.log(ALPHA)), 0.3)


def test_cell_averages_of_the_bias_are_those_of_the_extraction(cells, simulator):
    """One galaxy at the phase centre whose flux depends on frequency, through its visibilities and drawn."""
    flux, e = 5e-5, 0.3 - 0.2j
    sky = one_galaxy(flux, ALPHA, e, spectral_index=-0.7)
    catalogue = catalogue_from_galaxies(sky, plan().track.phase_centre)
    visibilities = list(simulate(catalogue, plan(), seed=None).chunks())
    nothing = np.zeros(2 * (simulator.cutout.size // 2) ** 2, complex)
    drawn = simulator.facet(GalaxyFit(flux, np.zeros(2), e, ALPHA, 0.0), Exponential(), nothing)
    rung = LADDER ** np.ceil(np.log(ALPHA) / np.log(LADDER))
    longest, highest = float(np.hypot(*cells.uv[-1])), float(plan().channels.frequency.max())
    target = Target(sky, rung, UvRange(0.0, longest), highest)
    builder = CellAverageFacets().open(target, Exponential())
    for block in visibilities:
        builder.add(block, replace(sky, flux=np.zeros(1)))
    facet = builder.facet(sky)
    # The longest baselines that are used differ by a step of the scale length.
    same, inside = (np.hypot(*each.uv.T) < 2.2 / ALPHA for each in (drawn, facet))
    np.testing.assert_allclose(drawn.uv[same], facet.uv[inside], rtol=1e-6)
    np.testing.assert_allclose(drawn.power[same], facet.power[inside], rtol=1e-6)
    scale = np.abs(facet.correlation).max()
    np.testing.assert_allclose(
        drawn.correlation[same], facet.correlation[inside], atol=1e-5 * scale
    )


def test_the_noise_gives_the_galaxy_its_signal_to_noise_ratio(cells):
    """Of 10 uJy at the reference frequency, of the median size, round: 10, as the survey says."""
    size = Survey(plan()).population.size.prior(np.array([10 * MICROJANSKY]))
    prior = ShapePrior(float(size.log_median[0]), float(size.sigma[0]))
    drawn = cells.simulator(prior.log_scale_length, 0.3)
    snr = 10 * MICROJANSKY * drawn.snr_of_jansky(prior, Exponential())
    assert snr == pytest.approx(10, rel=0.02)  # without the spectrum: 8.24


def test_widths_come_in_steps_and_are_kept(cells):
    first = cells.simulator(np.log(1.0 * ARCSEC), 0.3)
    assert cells.simulator(np.log(1.0 * ARCSEC * LADDER**0.01), 0.1) is first or (
        cells.simulator(np.log(1.0 * ARCSEC * LADDER**-0.01), 0.1) is first
    )
    tiny = cells.simulator(np.log(1e-3 * ARCSEC), 0.3)
    assert tiny.cutout.size == 2 * SMALLEST
    assert np.all(first.power > 0)


def test_the_width_of_a_facet_is_a_number_of_scale_lengths():
    count = ScaleLengthCount(5e5, 38.0)
    found = count.cells(ALPHA) / (2 * 5e5 * 38.0 * ALPHA)
    assert 1 <= found < LADDER * 1.01
    assert count.cells(2 * ALPHA) % 2 == 0


def test_noise_is_turned_as_a_sky_is(simulator):
    """The noise of a point at x looks, after the turn, like that of a point at the turned place."""
    half = simulator.cutout.size // 2
    i, j = np.meshgrid(np.arange(2 * half), np.arange(half), indexing="ij")
    u, v = (i - half + 0.5) * simulator.cell, (j + 0.5) * simulator.cell
    l, m = 0.4 / (half * simulator.cell), -0.1 / (half * simulator.cell)
    point = np.exp(2j * np.pi * (u * l + v * m)).ravel()
    turned = np.exp(2j * np.pi * (u * -m + v * l)).ravel()
    np.testing.assert_allclose(simulator.turned(point), turned, atol=1e-9)


def test_noise_has_the_variance_of_the_sums(simulator):
    rng = np.random.default_rng(4)
    nothing = GalaxyFit(0.0, np.zeros(2), 0j, ALPHA, 0.0)
    facet = simulator.facet(nothing, Exponential(), simulator.draw_noise(rng))
    pulls = facet.correlation / np.sqrt(facet.power)
    assert np.std(pulls.real) == pytest.approx(1, abs=4 / np.sqrt(2 * len(pulls)))
    assert np.std(pulls.imag) == pytest.approx(1, abs=4 / np.sqrt(2 * len(pulls)))


def test_other_factors_change_signal_and_noise_differently():
    rng = np.random.default_rng(7)
    uv, natural = rng.uniform(-1e5, 1e5, (5000, 2)), rng.uniform(0.5, 2, 5000)
    factors, rule = rng.uniform(0.2, 1, 5000), ScaleLengthCount(1e5, 20.0)
    drawn = CellAverageBeam.from_samples(uv, natural, factors, 3.0, rule).simulator(
        np.log(1e-5), 0.3
    )
    assert drawn.power.sum() == pytest.approx(3 * np.sum(natural * factors))
    assert drawn.noise_power.sum() == pytest.approx(9 * np.sum(natural * factors**2))
