"""Slightly indefinite matrices, in units that differ by many orders of magnitude."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from uvshear.numerics.symmetric import (
    FLOOR,
    regularised_inverse,
    smallest_eigenvalue,
    with_eigenvalue_floor,
)

UNITS = np.array([1e6, 1.0, 3.0, 1e-5])


def _positive(seed=1):
    root = np.random.default_rng(seed).normal(size=(4, 7))
    return root @ root.T * np.outer(UNITS, UNITS)


def _indefinite():
    """Unit diagonal but for the units, with one eigenvalue below zero."""
    matrix = np.eye(4)
    matrix[0, 1] = matrix[1, 0] = 1.01
    return matrix * np.outer(UNITS, UNITS)


@given(st.integers(0, 50))
def test_a_positive_matrix_stays_as_it_is(seed):
    matrix = _positive(seed)
    units = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
    np.testing.assert_allclose(with_eigenvalue_floor(matrix) / units, matrix / units, atol=1e-12)
    identity = regularised_inverse(matrix) @ matrix
    np.testing.assert_allclose(identity * np.outer(UNITS, 1 / UNITS), np.eye(4), atol=1e-7)


def test_eigenvalues_are_raised_to_the_floor_in_units_of_the_diagonal():
    matrix = _indefinite()
    assert smallest_eigenvalue(matrix) == pytest.approx(-0.01)
    raised = with_eigenvalue_floor(matrix, 0.1) / np.outer(UNITS, UNITS)
    np.testing.assert_allclose(np.linalg.eigvalsh(raised), [0.1, 1.0, 1.0, 2.01], rtol=1e-12)
    positive = with_eigenvalue_floor(matrix, 0.0) / np.outer(UNITS, UNITS)
    np.testing.assert_allclose(np.linalg.eigvalsh(positive), [0, 1, 1, 2.01], atol=1e-12)


def test_the_inverse_of_an_indefinite_matrix_is_that_of_the_raised_one():
    matrix = _indefinite()
    scaled = regularised_inverse(matrix) * np.outer(UNITS, UNITS)
    expected = np.linalg.inv(with_eigenvalue_floor(matrix) / np.outer(UNITS, UNITS))
    np.testing.assert_allclose(scaled, expected, rtol=1e-6)
    assert np.linalg.eigvalsh(scaled).max() == pytest.approx(1 / FLOOR, rel=1e-6)


def test_a_parameter_without_information_makes_the_matrix_singular_and_no_more():
    matrix = _positive()
    matrix[2] = matrix[:, 2] = 0.0
    assert smallest_eigenvalue(matrix) == pytest.approx(0.0, abs=1e-12)
    assert np.all(np.isfinite(with_eigenvalue_floor(matrix)))


def test_a_negative_diagonal_has_a_positive_part():
    np.testing.assert_allclose(
        with_eigenvalue_floor(np.diag([2.0, -3.0]), 0.0), np.diag([2.0, 0.0]), atol=1e-15
    )
