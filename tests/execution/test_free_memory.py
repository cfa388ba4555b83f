"""Freed memory is given back to the system."""

import ctypes
from pathlib import Path

import numpy as np
import pytest

from uvshear.execution import free_memory, give_back_free_memory

HAS_TRIM = hasattr(ctypes.CDLL(None), "malloc_trim")


def _resident():
    lines = Path("/proc/self/status").read_text().splitlines()
    (line,) = (line for line in lines if line.startswith("RssAnon"))
    return 1024 * int(line.split()[1])


@pytest.mark.skipif(not HAS_TRIM, reason="the C library keeps no such memory, or for ever")
def test_freed_arrays_are_given_back_between_those_in_use():
    np.ones(4_000_000)  # from now on, arrays of up to 32 MB are kept
    arrays = [np.ones(100_000) for _ in range(250)]
    kept = arrays[::25]
    arrays.clear()
    before = _resident()
    give_back_free_memory()
    # 192 MB are free; without the call, none is given back.
    assert before - _resident() > 150e6
    assert all(array.sum() == 100_000 for array in kept)


def test_another_c_library_is_left_alone(monkeypatch):
    monkeypatch.setattr(free_memory.ctypes, "CDLL", lambda _: object())
    give_back_free_memory()
