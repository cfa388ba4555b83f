"""Envelopes and their slopes, compiled: one pass over q, in the precision of q.

Constants are cast to the dtype of q, for a Python number would make float32 arithmetic float64.
"""

import numpy as np
from numba import njit

from uvshear.typing import Array

_elementwise = njit(fastmath=True, error_model="numpy", cache=True, nogil=True)


@_elementwise
def exponential_envelope(q: Array) -> Array:
    """(1+q)^(-3/2)."""
    one = q.dtype.type(1)
    out = np.empty_like(q)
    for i in range(q.size):
        s = one + q[i]
        out[i] = one / (s * np.sqrt(s))
    return out


@_elementwise
def exponential_slope(q: Array) -> Array:
    """-3/2 (1+q)^(-5/2)."""
    one, factor = q.dtype.type(1), q.dtype.type(-1.5)
    out = np.empty_like(q)
    for i in range(q.size):
        s = one + q[i]
        out[i] = factor / (s * s * np.sqrt(s))
    return out


@_elementwise
def gaussian_envelope(q: Array) -> Array:
    """exp(-q/2)."""
    half = q.dtype.type(-0.5)
    out = np.empty_like(q)
    for i in range(q.size):
        out[i] = np.exp(half * q[i])
    return out


@_elementwise
def gaussian_slope(q: Array) -> Array:
    """-1/2 exp(-q/2)."""
    half = q.dtype.type(-0.5)
    out = np.empty_like(q)
    for i in range(q.size):
        out[i] = half * np.exp(half * q[i])
    return out
