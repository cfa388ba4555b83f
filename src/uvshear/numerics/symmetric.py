"""Symmetric matrices that should be positive, and that rounding or truncation has left slightly indefinite.

Parameters have different units, and eigenvalues of their Fisher matrix would depend on these: every function here works
in units in which the diagonal is one.
"""

import numpy as np

from uvshear.typing import Array, Float

FLOOR = 1e-6
"""Smallest credible eigenvalue of a matrix of unit diagonal."""


def smallest_eigenvalue(matrix: Float[Array, "n n"]) -> float:
    """Smallest eigenvalue of the matrix in units in which its diagonal is one."""
    return float(np.linalg.eigvalsh(matrix / _units(matrix)).min())


def with_eigenvalue_floor(matrix: Float[Array, "n n"], floor: float = FLOOR) -> Float[Array, "n n"]:
    """Raise the eigenvalues that are below ``floor`` to it; with a floor of zero this is the positive part."""
    units = _units(matrix)
    values, vectors = np.linalg.eigh(matrix / units)
    return (vectors * np.maximum(values, floor)) @ vectors.T * units


def regularised_inverse(matrix: Float[Array, "n n"], floor: float = FLOOR) -> Float[Array, "n n"]:
    """Inverse of the matrix with its eigenvalues raised to ``floor`` at least."""
    units = _units(matrix)
    values, vectors = np.linalg.eigh(matrix / units)
    return (vectors / np.maximum(values, floor)) @ vectors.T / units


def _units(matrix: Float[Array, "n n"]) -> Float[Array, "n n"]:
    """Product of the units of rows and columns."""
    # Differences of matrices may have a negative diagonal, and parameters without information have zero.
    scale = np.sqrt(np.maximum(np.abs(np.diag(matrix)), 1e-300))
    return np.outer(scale, scale)
