import numpy as np
import pytest

from uvshear.reproduce.visibility_cells import VisibilityCells

RNG = np.random.default_rng(3)
UV = RNG.uniform(-100, 100, (400, 2))
WEIGHT = RNG.uniform(0.5, 2.0, 400)
CELLS = VisibilityCells(UV, WEIGHT, 8)


def _cell_of(k: int) -> int:
    """Number of the cell that holds a sample, by its distance from the centres."""
    folded = UV[k] if UV[k, 1] >= 0 else -UV[k]
    return int(np.argmin(np.abs(CELLS.centres - folded).max(axis=1)))


PLACE = np.array([_cell_of(k) for k in range(400)])


def test_weights_and_means_are_those_of_the_samples():
    folded = np.where(UV[:, 1:] < 0, -UV, UV)
    np.testing.assert_allclose(CELLS.weight, np.bincount(PLACE, WEIGHT))
    for axis in (0, 1):
        sums = np.bincount(PLACE, WEIGHT * folded[:, axis])
        np.testing.assert_allclose(CELLS.means[:, axis], sums / CELLS.weight)
    assert np.abs(CELLS.means - CELLS.centres).max() <= CELLS.side / 2


def test_samples_of_the_other_half_plane_are_conjugated():
    values = RNG.normal(size=400) + 1j * RNG.normal(size=400)
    folded = np.where(UV[:, 1] < 0, values.conj(), values)
    expected = np.bincount(PLACE, WEIGHT * folded.real) + 1j * np.bincount(
        PLACE, WEIGHT * folded.imag
    )
    np.testing.assert_allclose(CELLS.total(values), expected)


def test_propagated_errors_are_those_of_the_mean():
    factors = RNG.uniform(0.1, 3.0, 400)
    values = np.ones(400, complex)
    facet = CELLS.propagated_facet(values, factors)
    once, twice = (np.bincount(PLACE, WEIGHT * factors**n) for n in (1, 2))
    np.testing.assert_allclose(facet.power, once**2 / twice)
    np.testing.assert_allclose(facet.correlation / facet.power, 1)
    assert np.all(facet.power <= CELLS.weight * (1 + 1e-12))
    natural = CELLS.natural_facet(values)
    same = CELLS.propagated_facet(values, np.ones(400))
    np.testing.assert_allclose(same.correlation, natural.correlation)


def test_other_weights_are_scaled():
    facet = CELLS.weighted_facet(np.ones(400, complex), np.full(400, 2.0), 0.25)
    np.testing.assert_allclose(facet.power, CELLS.weight / 2)
    assert facet.correlation.sum() == pytest.approx(CELLS.weight.sum() / 2)


def test_the_distance_from_the_centre_is_that_of_the_weighted_mean():
    factors = RNG.uniform(0.1, 3.0, 400)
    folded = np.where(UV[:, 1:] < 0, -UV, UV)
    sums = [np.bincount(PLACE, WEIGHT * factors * folded[:, axis]) for axis in (0, 1)]
    means = np.column_stack(sums) / np.bincount(PLACE, WEIGHT * factors)[:, None]
    np.testing.assert_allclose(CELLS.means_with(WEIGHT * factors), means)
    squared = np.sum((means - CELLS.centres) ** 2, axis=1)
    expected = np.sqrt(np.sum(CELLS.weight * squared) / np.sum(CELLS.weight)) / CELLS.side
    assert CELLS.off_centre(WEIGHT * factors) == pytest.approx(expected)
