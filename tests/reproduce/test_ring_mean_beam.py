import numpy as np
import pytest

from tests.reproduce.surveys import small_survey
from uvshear.constants import ARCSEC
from uvshear.imaging.cutout import cutout
from uvshear.reproduce.facet_ways import ExactFacetWay
from uvshear.reproduce.ring_mean_beam import RingMeanBeam, ring_means_of_cells

CELLS = cutout(64, 0.5 * ARCSEC, 0.0, 1.5e5)


def test_the_power_of_a_round_beam_hardly_changes():
    power = np.exp(-np.sum(CELLS.uv**2, axis=-1) / (2 * 4e4**2))
    np.testing.assert_allclose(ring_means_of_cells(CELLS, power), power, atol=0.06)


def test_an_elongated_beam_becomes_round_and_keeps_its_power():
    u, v = CELLS.uv.T
    power = np.exp(-(u**2 + 4 * v**2) / (2 * 4e4**2))
    mean = ring_means_of_cells(CELLS, power)
    assert mean.sum() == pytest.approx(power.sum(), rel=1e-12)
    elongation = [
        np.sum(each * (u**2 - v**2)) / np.sum(each * (u**2 + v**2)) for each in (power, mean)
    ]
    assert elongation[0] > 0.5
    assert abs(elongation[1]) < 0.02


def test_simulators_have_the_ring_means_and_are_kept():
    beam = ExactFacetWay().beam(small_survey().samples(), ARCSEC)
    size = float(np.log(2 * ARCSEC)), 0.3
    before, rings = beam.simulator(*size), RingMeanBeam(beam)
    found = rings.simulator(*size)
    np.testing.assert_array_equal(found.power, ring_means_of_cells(before.cutout, before.power))
    assert found.cutout == before.cutout
    assert rings.simulator(*size) is found
