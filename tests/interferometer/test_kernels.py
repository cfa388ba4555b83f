"""Kernels of the attenuations against numpy."""

import numpy as np
import pytest

from uvshear.interferometer import kernels

UVW = np.random.default_rng(6).uniform(-3e4, 3e4, (3, 400))
DIRECTION = (1e-3, -2e-3, 1e-6)


@pytest.mark.parametrize(
    ("kernel", "dtype", "allowed"),
    [
        (kernels.multiply_by_sinc, np.float64, 1e-12),
        (kernels.multiply_by_sinc_single, np.float32, 1e-6),
    ],
)
@pytest.mark.parametrize("scale", [0.0, 1e-9, 1e-3, 0.03, 1.0])
def test_averages_over_phases_are_those_of_numpy(kernel, dtype, allowed, scale):
    factor = np.full(400, 0.5, dtype)
    kernel(UVW, DIRECTION, np.full(400, scale), factor)
    expected = 0.5 * np.sinc(scale * (DIRECTION @ UVW))
    assert scale < 0.03 or expected.min() < 0
    np.testing.assert_allclose(factor, expected, rtol=0, atol=allowed)


def test_entries_of_a_table_are_multiplied():
    factor = np.array([1.0, 2.0, 3.0])
    kernels.multiply_by_entries(np.array([0.5, 2.0]), np.array([1, 0, 1], np.int32), factor)
    np.testing.assert_array_equal(factor, [2.0, 1.0, 6.0])
