"""The decorators with which all numba kernels of the package are compiled."""

from collections.abc import Callable
from typing import Any

import numba

compiled: Callable[..., Any] = numba.njit(
    fastmath=True, error_model="numpy", cache=True, nogil=True
)
"""Compile a kernel: vectorised (no check of divisions, sums in any order), cached on disk, without Python's lock."""

inlined: Callable[..., Any] = numba.njit(
    fastmath=True, error_model="numpy", cache=True, nogil=True, inline="always"
)
"""Compile a function that is called within loops which should vectorise."""
