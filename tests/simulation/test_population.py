import numpy as np
import pytest

from uvshear.constants import ARCMIN, SPECTRAL_INDEX
from uvshear.errors import InputError
from uvshear.galaxy import DiscEllipticityPrior, SizeFluxRelation
from uvshear.simulation.population import (
    PAPER_DENSITY,
    Population,
    draw_population,
    expected_number,
)
from uvshear.simulation.sky_region import DiscField, SquareField

DEGREE = 60 * ARCMIN


def drawn(number=20_000, ring=10, seed=11):
    return draw_population(
        Population(ring=ring), SquareField(DEGREE), number=number, rng=np.random.default_rng(seed)
    )


def test_the_papers_square_degree_holds_9720_galaxies():
    assert expected_number(SquareField(DEGREE), PAPER_DENSITY) == 9720
    assert expected_number(SquareField(DEGREE), PAPER_DENSITY, ring=7) == 9723
    assert expected_number(DiscField(10 * ARCMIN), 1 / ARCMIN**2) == 314


def test_a_ring_has_no_mean_ellipticity_and_shares_size_and_flux():
    galaxies = drawn()
    e = galaxies.ellipticity.reshape(-1, 10)
    assert np.abs(e.mean(axis=1)).max() < 1e-15
    steps = np.angle(e / np.roll(e, 1, axis=1))
    np.testing.assert_allclose(steps, 2 * np.pi / 10, atol=1e-12)
    for column in (np.abs(galaxies.ellipticity), galaxies.flux, galaxies.scale_length):
        assert np.all(np.ptp(column.reshape(-1, 10), axis=1) < 1e-15)
    assert np.ptp(galaxies.l.reshape(-1, 10), axis=1).min() > 0.1 * DEGREE
    assert np.all(galaxies.spectral_index == SPECTRAL_INDEX)


def test_shapes_follow_the_prior_and_sizes_the_flux():
    number = 40_000
    galaxies = drawn(number, ring=1)
    squared = np.abs(galaxies.ellipticity) ** 2 / 2
    error = squared.std() / np.sqrt(number)
    assert abs(squared.mean() - DiscEllipticityPrior().population_variance) < 3 * error
    assert error < 0.01 * squared.mean()
    relation = SizeFluxRelation()
    scatter = np.log(galaxies.scale_length / relation.median(galaxies.flux))
    assert abs(scatter.mean()) < 3 * relation.sigma / np.sqrt(number)
    assert abs(scatter.std() / relation.sigma - 1) < 3 / np.sqrt(2 * number)
    slope = np.polyfit(np.log(galaxies.flux), np.log(galaxies.scale_length), 1)[0]
    slope_error = relation.sigma / np.log(galaxies.flux).std() / np.sqrt(number)
    assert abs(slope - relation.slope) < 3 * slope_error
    assert slope_error < 0.01


def test_orientations_are_isotropic():
    number = 40_000
    phase = drawn(number, ring=1).ellipticity
    mean = (phase / np.abs(phase)).mean()
    assert abs(mean) < 3 / np.sqrt(number)


@pytest.mark.parametrize("sky", [SquareField(DEGREE), DiscField(0.5 * DEGREE)], ids=repr)
def test_positions_fill_the_field_uniformly(sky):
    number = 40_000
    l, m = sky.draw(number, np.random.default_rng(12))
    half = 0.5 * DEGREE
    if isinstance(sky, SquareField):
        assert max(np.abs(l).max(), np.abs(m).max()) <= half
        inner = (np.abs(l) < half / 2) & (np.abs(m) < half / 2)
    else:
        assert np.hypot(l, m).max() <= half
        inner = np.hypot(l, m) < half / 2
    error = np.sqrt(0.25 * 0.75 / number)  # the inner half has a quarter of the area
    assert abs(inner.mean() - 0.25) < 3 * error
    for coordinate in (l, m):
        assert abs(coordinate.mean()) < 3 * coordinate.std() / np.sqrt(number)
    assert abs(np.corrcoef(l, m)[0, 1]) < 3 / np.sqrt(number)


def test_one_seed_gives_one_population():
    first, again, other = drawn(100), drawn(100), drawn(100, seed=12)
    np.testing.assert_array_equal(first.ellipticity, again.ellipticity)
    assert np.all(first.l != other.l)


def test_broken_rings_are_refused():
    with pytest.raises(InputError, match="do not make whole rings of 10"):
        drawn(15)
    with pytest.raises(InputError, match="ring is 0"):
        Population(ring=0)
