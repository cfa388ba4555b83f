import numpy as np
import pytest

from tests.reproduce.surveys import small_survey
from uvshear.bias.cell_average import CellAverageBeam
from uvshear.constants import ARCSEC
from uvshear.extraction.paper.cell_average import ScaleLengths
from uvshear.galaxy import Exponential
from uvshear.interferometer.weighting import RoundPsf
from uvshear.reproduce.cell_counts import FixedCount
from uvshear.reproduce.facet_ways import CellFacets
from uvshear.shapes.measurement import GalaxyFit

ALPHA = 1.5 * ARCSEC
GALAXY = GalaxyFit(5e-5, np.zeros(2), 0.3 - 0.2j, ALPHA, 0.0)


@pytest.fixture(scope="module")
def simulator():
    beam = small_survey(CellFacets(FixedCount(200))).experiment().beam
    return beam.simulator(float(np.log(ALPHA)), 0.3)


def test_facets_without_noise_are_those_of_the_other_implementation(simulator):
    """The same number of cells by the rule of the scale lengths."""
    samples = small_survey().samples()
    other = CellAverageBeam.gather(samples.seen)
    scaled = 100 / (other.longest * 1.4e9 / other.frequency * ALPHA)
    other = CellAverageBeam(
        other.samples, other.longest, other.frequency, ScaleLengths(scaled * 0.97)
    )
    theirs = other._of_size(ALPHA)
    half = theirs.cutout.size // 2
    mine = small_survey(CellFacets(FixedCount(2 * half))).experiment().beam
    ours = mine.simulator(float(np.log(ALPHA * 1.0001)), 0.3)
    one = ours.facet(GALAXY, Exponential(), np.zeros(2 * half * half, complex))
    two = theirs.facet(GALAXY, Exponential(), np.zeros(len(theirs.power), complex))
    inside = np.hypot(*one.uv.T) < 2.2 / ALPHA
    same = np.hypot(*two.uv.T) < 2.2 / ALPHA
    np.testing.assert_allclose(one.uv[inside], two.uv[same], rtol=1e-6)
    np.testing.assert_allclose(one.power[inside], two.power[same], rtol=1e-6)
    scale = np.abs(two.correlation).max()
    np.testing.assert_allclose(one.correlation[inside], two.correlation[same], atol=1e-5 * scale)


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


def test_other_weights_change_signal_and_noise_differently():
    survey = small_survey(CellFacets(FixedCount(100)), weightings=(RoundPsf(),))
    simulator = survey.experiment().beam.simulator(float(np.log(ALPHA)), 0.3)
    ratio = simulator.noise_power / simulator.power
    assert ratio.min() < 0.8
    assert ratio.max() > 1.1
