"""Arrays in memory that this process shares with its copies."""

import math
import mmap
import os
from collections import deque
from collections.abc import Sequence
from threading import Lock
from typing import Final
from weakref import finalize

import numpy as np
from numpy.typing import DTypeLike

from uvshear.typing import Array

_NO_RESERVE: Final[int] = getattr(mmap, "MAP_NORESERVE", 0x4000)


def shared_zeros(shape: Sequence[int], dtype: DTypeLike) -> Array:
    """Return an array of zeros in memory that this process shares with copies of it that are made later.

    Copies that were made earlier share it too, if the process had a common region (:func:`reserve_region`) when they
    were made; they learn of the array when it is handed over to them (``handing_over``). All of them see what any of
    them writes. Pages that are never written occupy no physical memory.

    Raises
    ------
    MemoryError
        The system does not give that much memory.
    """
    size = math.prod(shape) * np.dtype(dtype).itemsize
    if size == 0:
        return np.zeros(tuple(shape), dtype)
    if (region := common_region()) is not None:
        return region.zeros(size).view(dtype).reshape(tuple(shape))
    try:
        memory = mmap.mmap(-1, size)
    except OSError as error:
        raise MemoryError(f"{size} bytes of shared memory") from error
    return np.frombuffer(memory, dtype).reshape(tuple(shape))


class Region:
    """A range of addresses that a process and its later copies have in common, in which arrays come and go.

    Only the process that has made the region takes arrays from it. Their memory is given back to the system when they
    are no longer used.

    Parameters
    ----------
    size
        Length of the range [bytes], a multiple of the size of a page.

    Raises
    ------
    OSError
        The system does not give that many addresses.
    """

    def __init__(self, size: int) -> None:
        self.owner = os.getpid()
        memory = mmap.mmap(-1, size, flags=mmap.MAP_SHARED | _NO_RESERVE)
        self._memory, self._bytes = memory, np.frombuffer(memory, np.uint8)
        self._address = self._bytes.ctypes.data
        self._free = [(0, size)]
        self._lock = Lock()
        # The garbage collector may release arrays while this process holds the lock.
        self._released = deque[tuple[int, int]]()

    def zeros(self, size: int) -> Array:
        """Return an array of zeros [uint8].

        Raises
        ------
        MemoryError
            No gap between the arrays in use is that long.
        """
        pages = -(-size // mmap.PAGESIZE) * mmap.PAGESIZE
        with self._lock:
            start = self._taken(pages)
        found = np.frombuffer(self._memory, np.uint8, size, start)
        # Numpy's views of this array keep it alive. At the end of the process all memory is given back anyway.
        finalize(found, self._release, start, start + pages).atexit = False
        return found

    def place_of(self, array: Array) -> int | None:
        """Return where the memory of an array begins in the region; None if it lies elsewhere."""
        place = int(array.__array_interface__["data"][0]) - self._address
        return place if 0 <= place < len(self._bytes) else None

    def at(self, place: int, size: int) -> memoryview:
        """Return the bytes at a place."""
        return memoryview(self._memory)[place : place + size]

    def _taken(self, pages: int) -> int:
        """Take some bytes out of the first gap that is long enough, and return where they begin."""
        if self._released:
            while self._released:
                self._free.append(self._released.popleft())
            self._free = _joined(self._free)
        for number, (start, end) in enumerate(self._free):
            if end - start >= pages:
                self._free[number] = start + pages, end
                return start
        raise MemoryError(f"{pages} bytes of shared memory")

    def _release(self, start: int, end: int) -> None:
        # That a copy no longer uses an array does not mean that the other processes have finished with it.
        if os.getpid() == self.owner:
            self._memory.madvise(mmap.MADV_REMOVE, start, end - start)
            self._released.append((start, end))


def _joined(gaps: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Join gaps that touch; empty ones are left out."""
    joined: list[tuple[int, int]] = []
    for start, end in sorted(gaps):
        if start == end:
            continue
        if joined and joined[-1][1] == start:
            joined[-1] = joined[-1][0], end
        else:
            joined.append((start, end))
    return joined


_reserved: list[Region] = []


def reserve_region() -> bool:
    """Let shared arrays of this process lie in a common region from now on; tell whether the system allows it.

    It is as long as the machine's physical memory; its pages occupy memory only once they are written.
    """
    if common_region() is None:
        try:
            _reserved[:] = [Region(mmap.PAGESIZE * os.sysconf("SC_PHYS_PAGES"))]
        except OSError:  # a limit of the address space
            return False
    return True


def common_region() -> Region | None:
    """Return the common region from which this process takes arrays, if it has one."""
    return next((region for region in _reserved if region.owner == os.getpid()), None)


def inherited_region() -> Region:
    """Return the common region of the process that this process was copied from."""
    return _reserved[0]
