"""Kernels of the attenuations against numpy."""

import numpy as np
import pytest

from uvshear.interferometer import kernels

UVW = np.random.default_rng(6).uniform(-3e4, 3e4, (3, 400))
DIRECTIONS = np.array([[1e-3, -2e-3, 1e-6], [-2e-3, 1e-3, -3e-6]])


@pytest.mark.parametrize(
    ("kernel", "dtype", "allowed"),
    [
        (kernels.multiply_by_sinc, np.float64, 1e-12),
        (kernels.multiply_by_sinc_single, np.float32, 1e-6),
    ],
)
@pytest.mark.parametrize("scale", [0.0, 1e-9, 1e-3, 0.03, 1.0])
def test_averages_over_phases_are_those_of_numpy(kernel, dtype, allowed, scale):
    factors = np.full((2, 400), 0.5, dtype)
    kernel(UVW, DIRECTIONS, np.full(400, scale), factors)
    expected = 0.5 * np.sinc(scale * (DIRECTIONS @ UVW))
    assert scale < 0.03 or expected.min() < 0
    np.testing.assert_allclose(factors, expected, rtol=0, atol=allowed)


def test_entries_of_a_table_are_multiplied():
    factors = np.array([[1.0, 2.0, 3.0], [1.0, 1.0, 1.0]])
    tables = np.array([[0.5, 2.0], [3.0, 4.0]])
    kernels.multiply_by_entries(tables, np.array([1, 0, 1], np.int32), factors)
    np.testing.assert_array_equal(factors, [[2.0, 1.0, 6.0], [4.0, 3.0, 4.0]])
