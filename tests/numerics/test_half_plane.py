"""Half of a plane against all of it."""

import numpy as np
import pytest
from scipy import fft

from uvshear.numerics.half_plane import half_plane

PIXEL = 1e-5


@pytest.mark.parametrize("size", [16, 18])
def test_every_pair_of_opposite_cells_is_there_once(size):
    cells = half_plane(size, PIXEL, 0.0, 0.45 / PIXEL)
    step = 1 / (size * PIXEL)
    whole = np.rint(np.concatenate([cells.uv, -cells.uv]) / step).astype(int)
    axis = np.arange(-size, size + 1)
    u, v = np.meshgrid(axis, axis, indexing="ij")
    within = np.hypot(u, v) * step <= 0.45 / PIXEL
    assert {tuple(k) for k in whole.tolist()} == set(
        zip(u[within].tolist(), v[within].tolist(), strict=True)
    )
    assert cells.multiplicity.sum() == within.sum()


def test_sums_over_the_whole_plane_are_those_with_multiplicities():
    """Parseval's theorem for an image without power at the edge of the plane."""
    size = 32
    u, v = fft.fftfreq(size, PIXEL), fft.rfftfreq(size, PIXEL)
    longest = 0.4 / PIXEL
    image = np.random.default_rng(1).normal(size=(size, size))
    spectrum = fft.rfft2(image) * (np.hypot(u[:, None], v[None, :]) <= longest)
    smooth = fft.irfft2(spectrum, s=(size, size))
    cells = half_plane(size, PIXEL, 0.0, longest)
    total = np.sum(cells.multiplicity * np.abs(spectrum[cells.index]) ** 2) / size**2
    assert total == pytest.approx(np.sum(smooth**2), rel=1e-12)


def test_limits_are_distances_from_the_origin():
    cells = half_plane(64, PIXEL, 5e3, 2e4)
    distance = np.hypot(*cells.uv.T)
    assert distance.min() >= 5e3
    assert distance.max() <= 2e4
    np.testing.assert_array_equal(cells.multiplicity, 2.0)
    u, v = fft.fftfreq(64, PIXEL), fft.rfftfreq(64, PIXEL)
    i, j = cells.index
    np.testing.assert_array_equal(cells.uv, np.column_stack([u[i], v[j]]))
