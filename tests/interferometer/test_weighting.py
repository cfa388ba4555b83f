import math
from collections import Counter

import numpy as np
import pytest
from scipy.optimize import minimize

from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.baseline_map import map_baselines, rings_of
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.interferometer.weighting import (
    Briggs,
    GaussianTaper,
    RoundPsf,
    TukeyTaper,
    Uniform,
    weighted,
)

FREQUENCY = np.array([1.0e9, 1.2e9])
FIELD = math.radians(0.1)


def _observation(seed: int = 3, rows: int = 300) -> VisibilitySet:
    rng = np.random.default_rng(seed)
    uvw = rng.normal(0, (900.0, 500.0, 100.0), (rows, 3))
    weights = rng.uniform(0.5, 2, (rows, 2))
    weights[5] = 0
    vis = np.ones((rows, 2), complex)
    blocks = tuple(
        Visibilities(uvw[part], FREQUENCY, vis[part], weights[part])
        for part in (slice(0, 100), slice(100, rows))
    )
    return VisibilitySet(PhaseCentre(0.0, 0.0), blocks)


def _samples(observation) -> np.ndarray:
    """u, v [wavelengths] and weight of every sample."""
    found = []
    for block in observation.chunks():
        for row in range(len(block)):
            for chan, frequency in enumerate(block.frequency):
                u, v = block.uvw[row, :2] * frequency / SPEED_OF_LIGHT
                found.append((u, v, block.weights[row, chan]))
    return np.array(found).T


def _cell(u: float, v: float) -> tuple[int, int]:
    if v < 0:
        u, v = -u, -v
    return math.floor(u * FIELD), math.floor(v * FIELD)


def _densities(observation) -> tuple[Counter, list]:
    """Weight of each cell, and the cell of each sample, one after the other."""
    density: Counter = Counter()
    cells = []
    for u, v, weight in _samples(observation).T:
        cells.append(_cell(u, v))
        density[cells[-1]] += weight
    return density, cells


def test_briggs_weights_are_their_formula() -> None:
    observation = _observation()
    density, cells = _densities(observation)
    total = sum(density.values())
    average = sum(weight**2 for weight in density.values()) / total
    f_squared = (5 * 10**-0.5) ** 2 / average
    natural = _samples(observation)[2]
    expected = [w / (1 + density[cell] * f_squared) for w, cell in zip(natural, cells, strict=True)]
    found = _samples(weighted(observation, (Briggs(0.5, FIELD),)))[2]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_uniform_weights_give_every_cell_the_same() -> None:
    observation = weighted(_observation(), (Uniform(FIELD),))
    held = [weight for weight in _densities(observation)[0].values() if weight > 0]
    assert len(held) > 50
    assert np.ptp(held) < 1e-12 * held[0]


@pytest.mark.parametrize(("robustness", "factors"), [(4.0, "natural"), (-4.0, "uniform")])
def test_briggs_weights_end_at_natural_and_uniform_ones(robustness: float, factors: str) -> None:
    observation = _observation()
    limit = observation if factors == "natural" else weighted(observation, (Uniform(FIELD),))
    found = _samples(weighted(observation, (Briggs(robustness, FIELD),)))[2]
    expected = _samples(limit)[2]
    np.testing.assert_allclose(found / found.sum(), expected / expected.sum(), rtol=1e-4)


def test_a_grid_that_is_too_large_is_refused() -> None:
    with pytest.raises(InputError, match="a smaller field is needed"):
        weighted(_observation(), (Uniform(math.radians(5e4)),))


def test_a_gaussian_taper_is_the_transform_of_its_beam() -> None:
    beam = 30 * ARCSEC
    u, v, factor = _samples(weighted(_observation(), (GaussianTaper(beam),)))
    factor = factor / np.where((natural := _samples(_observation())[2]) > 0, natural, 1)
    # of a Gaussian of unit volume: along x, an integral over many pixels
    x = np.linspace(-4 * beam, 4 * beam, 4001)
    profile = np.exp(-4 * math.log(2) * (x / beam) ** 2)
    length = np.hypot(u, v)
    expected = np.array([np.sum(profile * np.cos(2 * np.pi * r * x)) for r in length])
    expected /= profile.sum()
    np.testing.assert_allclose(factor[natural > 0], expected[natural > 0], atol=1e-9)


def test_a_tukey_taper_rises_and_falls_within_its_range() -> None:
    taper = TukeyTaper(shortest=1000.0, longest=5000.0, rise=500.0, fall=2000.0)
    length = np.array([999.0, 1000.0, 1250.0, 1500.0, 3000.0, 4000.0, 5000.0, 5001.0])
    uvw = np.zeros((8, 3))
    uvw[:, 0] = length * SPEED_OF_LIGHT / 1e9
    ones = np.ones((8, 1))
    block = Visibilities(uvw, np.array([1e9]), ones.astype(complex), ones)
    observation = weighted(VisibilitySet(PhaseCentre(0.0, 0.0), (block,)), (taper,))
    (seen,) = observation.chunks()
    expected = [0, 0, 0.5, 1, 1, 0.5, 0, 0]
    np.testing.assert_allclose(seen.weights[:, 0], expected, atol=1e-12)


def test_each_weighting_sees_the_one_before() -> None:
    cut = TukeyTaper(shortest=1500.0)
    both = weighted(_observation(), (cut, Uniform(FIELD)))
    density = _densities(both)[0]
    held = [weight for weight in density.values() if weight > 0]
    assert np.ptp(held) < 1e-12 * held[0]
    assert len(held) < len(density)


def _quadrupoles(observation) -> tuple[np.ndarray, np.ndarray]:
    """Sum of w exp(2 i phi) on each ring, and of w."""
    u, v, weight = _samples(observation)
    ring = rings_of(np.hypot(u, v))
    wave = np.exp(2j * np.arctan2(v, u))
    there = np.unique(ring)
    sums = np.array([np.sum((weight * wave)[ring == one]) for one in there])
    return sums, np.array([weight[ring == one].sum() for one in there])


def test_a_round_psf_has_no_quadrupole_on_any_ring() -> None:
    observation = _observation(rows=4000)
    before, held = _quadrupoles(observation)
    after, left = _quadrupoles(weighted(observation, (RoundPsf(),)))
    assert np.max(np.abs(before) / held.clip(min=1)) > 0.3
    # cells of the map are a degree wide
    assert np.max(np.abs(after)) < 2e-2 * held.max()
    assert np.sum(np.abs(after)) < 0.01 * np.sum(np.abs(before))
    assert left.sum() > 0.3 * held.sum()


def test_a_round_psf_stays_as_close_to_natural_weights_as_it_can() -> None:
    """One ring, against a solver for constrained minima."""
    rng = np.random.default_rng(1)
    angle = np.concatenate([rng.uniform(-0.5, 0.5, 12), rng.uniform(1.2, 1.8, 4)])
    uvw = 800.0 * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(16)])
    weight = rng.uniform(0.5, 2, (16, 1))
    block = Visibilities(uvw, np.array([1e9]), weight.astype(complex), weight)
    # As in the map, whose cells are a degree wide: all sums are over their mean directions.
    cells = map_baselines(VisibilitySet(PhaseCentre(0.0, 0.0), (block,)))
    waves = np.exp(2j * np.arctan2(cells.v, cells.u))
    solution = minimize(
        lambda t: np.sum(cells.weight * (t - 1) ** 2),
        np.ones(len(cells.weight)),
        jac=lambda t: 2 * cells.weight * (t - 1),
        bounds=[(0, None)] * len(cells.weight),
        constraints=[
            {"type": "eq", "fun": lambda t: np.sum(cells.weight * t * waves.real)},
            {"type": "eq", "fun": lambda t: np.sum(cells.weight * t * waves.imag)},
        ],
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 500},
    )
    factors = RoundPsf().factors_for(weighted(VisibilitySet(PhaseCentre(0.0, 0.0), (block,)), ()))
    angles = np.arctan2(cells.v, cells.u)
    uvw = 800.0 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    ones = np.ones((len(angles), 1))
    found = factors(Visibilities(uvw, np.array([1e9]), ones.astype(complex), ones))[:, 0]
    np.testing.assert_allclose(found, solution.x, atol=2e-5)
    assert found.min() < 0.5


def test_a_ring_that_cannot_be_round_keeps_nothing() -> None:
    uvw = np.array([[800.0, 0, 0], [790.0, 130.0, 0]])
    ones = np.ones((2, 1))
    block = Visibilities(uvw, np.array([1e9]), ones.astype(complex), ones)
    (seen,) = weighted(VisibilitySet(PhaseCentre(0.0, 0.0), (block,)), (RoundPsf(),)).chunks()
    assert seen.weights.max() == 0
