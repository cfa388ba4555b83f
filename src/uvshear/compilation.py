"""How every numba kernel of the package is compiled."""

from collections.abc import Callable
from typing import Any

import numba

compiled: Callable[..., Any] = numba.njit(
    fastmath=True, error_model="numpy", cache=True, nogil=True
)
"""Vectorised (no check of divisions, sums in any order), kept on disk, run beside other threads."""

inlined: Callable[..., Any] = numba.njit(
    fastmath=True, error_model="numpy", cache=True, nogil=True, inline="always"
)
"""The same, for functions called within loops that shall vectorise."""
