"""Cell averages that are drawn, against those of the paper's extraction."""

from dataclasses import replace

import numpy as np
import pytest

from tests.bias.surveys import SHEARS, one_galaxy, plan
from uvshear.bias.cell_average import LADDER, SMALLEST
from uvshear.bias.survey import Survey
from uvshear.constants import ARCSEC
from uvshear.extraction.paper.cell_average import CellAverageFacets
from uvshear.extraction.paper.facets import Target
from uvshear.galaxy import Exponential
from uvshear.interferometer.uv_range import UvRange
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline.simulate import simulate
from uvshear.shapes.measurement import GalaxyFit


@pytest.fixture(scope="module")
def cells():
    return Survey(plan(), averages_cells=True).isolated(SHEARS).beam


def test_cell_averages_of_the_bias_are_those_of_the_extraction(cells):
    """One galaxy at the phase centre, through its visibilities and drawn."""
    flux, alpha, e = 5e-5, 1.0 * ARCSEC, 0.3 - 0.2j
    sky = one_galaxy(flux, alpha, e)
    catalogue = catalogue_from_galaxies(sky, plan().track.phase_centre)
    visibilities = list(simulate(catalogue, plan(), seed=None).chunks())
    simulator = cells.simulator(np.log(alpha), 0.3)
    nothing = np.zeros(len(simulator.power), complex)
    drawn = simulator.facet(GalaxyFit(flux, np.zeros(2), e, alpha, 0.0), Exponential(), nothing)
    rung = LADDER ** np.ceil(np.log(alpha) / np.log(LADDER))
    target = Target(sky, rung, UvRange(0.0, cells.longest), cells.frequency)
    builder = CellAverageFacets().open(target, Exponential())
    for block in visibilities:
        builder.add(block, replace(sky, flux=np.zeros(1)))
    facet = builder.facet(sky)
    np.testing.assert_allclose(drawn.uv, facet.uv, rtol=1e-6)
    np.testing.assert_allclose(drawn.power, facet.power, rtol=1e-6)
    scale = np.abs(facet.correlation).max()
    np.testing.assert_allclose(drawn.correlation, facet.correlation, atol=1e-5 * scale)


def test_widths_come_in_steps_and_are_kept(cells):
    first = cells.simulator(np.log(1.0 * ARCSEC), 0.3)
    assert cells.simulator(np.log(1.0 * ARCSEC * LADDER**0.01), 0.1) is first or (
        cells.simulator(np.log(1.0 * ARCSEC * LADDER**-0.01), 0.1) is first
    )
    tiny = cells.simulator(np.log(1e-3 * ARCSEC), 0.3)
    assert tiny.cutout.size == 2 * SMALLEST
    assert np.all(first.power > 0)


def test_noise_is_that_of_the_sums_of_cells(cells):
    simulator = cells.simulator(np.log(1.0 * ARCSEC), 0.3)
    rng = np.random.default_rng(5)
    galaxy = GalaxyFit(0.0, np.zeros(2), 0j, ARCSEC, 0.0)
    pulls = [
        simulator.facet(galaxy, Exponential(), simulator.draw_noise(rng)).correlation
        / np.sqrt(simulator.power)
        for _ in range(20)
    ]
    assert np.var(np.real(pulls)) == pytest.approx(1, abs=0.05)
    assert np.var(np.imag(pulls)) == pytest.approx(1, abs=0.05)
