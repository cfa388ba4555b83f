"""Compiled envelopes and their slopes: one pass over q each, in the precision of q.

Constants are cast to the dtype of q, because a Python number would turn float32 arithmetic into float64.
"""

import numpy as np

from uvshear.compilation import compiled
from uvshear.typing import Array


@compiled
def exponential_envelope(q: Array) -> Array:
    """(1+q)^(-3/2)."""
    unity = q.dtype.type(1)
    out = np.empty_like(q)
    for i in range(q.size):
        s = unity + q[i]
        out[i] = unity / (s * np.sqrt(s))
    return out


@compiled
def exponential_slope(q: Array) -> Array:
    """-3/2 (1+q)^(-5/2)."""
    unity, factor = q.dtype.type(1), q.dtype.type(-1.5)
    out = np.empty_like(q)
    for i in range(q.size):
        s = unity + q[i]
        out[i] = factor / (s * s * np.sqrt(s))
    return out


@compiled
def gaussian_envelope(q: Array) -> Array:
    """exp(-q/2)."""
    half = q.dtype.type(-0.5)
    out = np.empty_like(q)
    for i in range(q.size):
        out[i] = np.exp(half * q[i])
    return out


@compiled
def gaussian_slope(q: Array) -> Array:
    """-1/2 exp(-q/2)."""
    half = q.dtype.type(-0.5)
    out = np.empty_like(q)
    for i in range(q.size):
        out[i] = half * np.exp(half * q[i])
    return out
