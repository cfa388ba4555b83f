import numpy as np
import pytest

from uvshear.constants import ARCSEC, SPEED_OF_LIGHT
from uvshear.diagnostics.psf import PsfAccumulator, point_spread_function
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.imaging import ImageGrid
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.interferometer.weighting import TukeyTaper, weighted

GRID = ImageGrid(32, 0.5 * ARCSEC)


def _observation(rows: int = 40) -> VisibilitySet:
    rng = np.random.default_rng(5)
    uvw = rng.normal(0, 3e3, (rows, 3))
    frequency = np.array([1.0e9, 1.2e9])
    weights = rng.uniform(0.5, 2, (rows, 2))
    weights[3] = 0
    noise = rng.normal(size=(rows, 2)) + 1j * rng.normal(size=(rows, 2))
    halves = (slice(0, rows // 3), slice(rows // 3, rows))
    return VisibilitySet(
        PhaseCentre(0.0, 0.0),
        tuple(Visibilities(uvw[h], frequency, noise[h], weights[h]) for h in halves),
    )


def _direct(observation: VisibilitySet, low: float, high: float) -> np.ndarray:
    x = (np.arange(GRID.size) - GRID.size // 2) * GRID.pixel
    l, m = np.meshgrid(x, x, indexing="ij")
    n_minus_one = np.sqrt(1 - l**2 - m**2) - 1
    image, total = np.zeros_like(l), 0.0
    for block in observation.blocks:
        for chan, nu in enumerate(block.frequency):
            for row in range(len(block)):
                u, v, w = block.uvw[row] * nu / SPEED_OF_LIGHT
                if low <= np.hypot(u, v) <= high:
                    weight = block.weights[row, chan]
                    image += weight * np.cos(2 * np.pi * (u * l + v * m + w * n_minus_one))
                    total += weight
    return image / total


@pytest.mark.parametrize(("low", "high"), [(0.0, np.inf), (5e3, 1.5e4)])
def test_the_psf_is_the_direct_sum_over_the_uv_range(low: float, high: float) -> None:
    observation = _observation()
    image = point_spread_function(weighted(observation, (TukeyTaper(low, high),)), GRID)
    np.testing.assert_allclose(image, _direct(observation, low, high), atol=2e-5)  # epsilon 1e-5


def test_an_empty_uv_range_is_refused() -> None:
    with pytest.raises(InputError, match="a wider uv range, or another weighting, is needed"):
        point_spread_function(weighted(_observation(), (TukeyTaper(1e7, 1e8),)), GRID)


def test_a_pass_in_two_parts_gives_the_psf_of_one() -> None:
    observation = _observation()
    first, later = PsfAccumulator(GRID), PsfAccumulator(GRID)
    first.add(observation.blocks[0])
    later.add(observation.blocks[1])
    first.merge(later)
    np.testing.assert_allclose(
        first.result(), point_spread_function(observation, GRID), rtol=0, atol=1e-12
    )
