"""Sheared data against the galaxy that is sheared itself, and what shearing does to noise."""

import numpy as np
import pytest

from uvshear.constants import ARCSEC
from uvshear.galaxy import Exponential
from uvshear.geometry.ellipticity import add_shear, sheared_scale_length
from uvshear.imaging.cutout import cutout
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.metacal import REACH, STEP, WIDEST, Metacalibration, scale_of
from uvshear.shapes.template import Template

WIDTH = 45 * ARCSEC
CELLS = cutout(100, WIDTH / 100, 0.0, 100e3)
ROUND = cutout(100, WIDTH / 100, 0.0, REACH * WIDEST)


def _power():
    """More to the North than to the East, and gaps."""
    u, v = CELLS.uv.T
    distance = np.hypot(u, v)
    power = CELLS.multiplicity * (1e11 * np.exp(-np.hypot(1.3 * u, 0.7 * v) / 12e3) + 1e9)
    gap = (np.sin(distance / 9e3) > 0.9) & (u > 0) & (distance > 15e3)
    assert gap.mean() > 0.04
    return np.where(gap, 0.0, power)


POWER = _power()
METACAL = Metacalibration(CELLS.uv, POWER, WIDTH, WIDEST, ROUND.uv, ROUND.multiplicity)
NOTHING = np.zeros(len(POWER), complex)


def _all(facets):
    return [facets.unsheared, *facets.sheared[0], *facets.sheared[1]]


SHEARS = [0j, STEP + 0j, -STEP + 0j, STEP * 1j, -STEP * 1j]


def test_sheared_data_are_those_of_the_sheared_galaxy():
    e, alpha, place = 0.3 - 0.2j, 0.9 * ARCSEC, np.array([0.4, -0.3]) * ARCSEC
    galaxy = GalaxyFit(2e-5, place, e, alpha, 0.0)
    data = POWER * Template(CELLS.uv, Exponential()).model(galaxy)
    for facet, g in zip(_all(METACAL.sheared_facets(data, NOTHING)), SHEARS, strict=True):
        after = add_shear(np.array([e]), g)
        size = sheared_scale_length(np.array([alpha]), np.array([e]), after)
        matrix = np.array([[1 + g.real, g.imag], [g.imag, 1 - g.real]]) / np.sqrt(1 - abs(g) ** 2)
        expected = GalaxyFit(2e-5, matrix @ place, complex(after[0]), float(size[0]), 0.0)
        model = facet.power * Template(facet.uv, Exponential()).model(expected)
        # measured 3e-5; a shear of the wrong sign: 1e-2
        np.testing.assert_allclose(facet.correlation, model, atol=2e-4 * np.abs(model).max())


def test_the_round_beam_has_no_direction():
    u, v = ROUND.uv.T
    power = METACAL.sheared_facets(NOTHING, NOTHING).unsheared.power
    # a square of cells cut by a circle: to rounding in u^2 - v^2 but for the cells at v = 0
    assert abs(np.sum(power * (u**2 - v**2))) < 1e-3 * np.sum(power * (u**2 + v**2))


def _quadrupole_response(counter):
    """Change with the shear of how noise looks like a galaxy along an axis."""
    rng = np.random.default_rng(4)
    u, v = ROUND.uv.T
    pattern = (u**2 - v**2) / WIDEST**2
    changes = []
    for _ in range(400):
        noise, more = ((a + 1j * b) for a, b in rng.standard_normal((2, 2, len(POWER))))
        data = np.sqrt(POWER) * noise
        facets = METACAL.sheared_facets(data, more if counter else NOTHING)
        plus, minus = facets.sheared[0]
        # power of the noise in the pattern, a quadratic form as every noise bias is
        changes.append(
            np.sum(pattern * (np.abs(plus.correlation) ** 2 - np.abs(minus.correlation) ** 2))
        )
    mean = np.mean(changes)
    return mean, np.std(changes) / np.sqrt(len(changes))


def test_counter_sheared_noise_leaves_noise_without_a_direction():
    bare, bare_err = _quadrupole_response(counter=False)
    mended, mended_err = _quadrupole_response(counter=True)
    assert abs(bare) > 8 * bare_err
    assert abs(mended) < 3 * mended_err
    assert mended_err < abs(bare) / 4


def test_the_noise_is_about_what_the_power_says():
    rng = np.random.default_rng(5)
    ratios = []
    for _ in range(50):
        noise, more = ((a + 1j * b) for a, b in rng.standard_normal((2, 2, len(POWER))))
        unsheared = METACAL.sheared_facets(np.sqrt(POWER) * noise, more).unsheared
        ratios.append(np.sum(unsheared.correlation.real**2) / np.sum(unsheared.power))
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.15)


def test_the_round_beam_ends_where_the_baselines_do():
    near = np.hypot(*CELLS.uv.T) < 30e3
    assert scale_of(CELLS.uv, POWER) == WIDEST
    assert REACH * scale_of(CELLS.uv, POWER * near) == pytest.approx(30e3, rel=0.06)
