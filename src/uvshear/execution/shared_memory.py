"""Arrays in memory that this process shares with its copies."""

import math
import mmap
from collections.abc import Sequence

import numpy as np
from numpy.typing import DTypeLike

from uvshear.typing import Array


def shared_zeros(shape: Sequence[int], dtype: DTypeLike) -> Array:
    """Return an array of zeros in memory that this process shares with copies of it that are made later.

    All of them see what any of them writes. Pages that are never written occupy no physical memory.

    Raises
    ------
    MemoryError
        The system does not give that much memory.
    """
    size = math.prod(shape)
    if size == 0:
        return np.zeros(tuple(shape), dtype)
    try:
        memory = mmap.mmap(-1, size * np.dtype(dtype).itemsize)
    except OSError as error:
        raise MemoryError(f"{size * np.dtype(dtype).itemsize} bytes of shared memory") from error
    return np.frombuffer(memory, dtype).reshape(tuple(shape))
