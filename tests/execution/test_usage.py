"""Time of processors and memory of a process and of those that work for it."""

import os
import time

import numpy as np
import pytest

from uvshear.execution import CAN_COPY, Copies
from uvshear.execution.usage import Usage

SIZE = 60e6
"""Memory that a task takes [bytes]."""


def _work(shared, seconds):
    """Use a processor for a time, and some memory until the process ends."""
    # The system may take more than a tenth of a second to provide the memory.
    end = time.process_time() + seconds
    _held.append(np.ones(int(SIZE / 8)))
    while time.process_time() < end:
        pass
    return os.getpid()


_held = []


def test_this_process_uses_time_and_memory():
    before = Usage.now()
    _work(None, 0.2)
    after = Usage.now()
    _held.clear()
    assert after.cpu_seconds - before.cpu_seconds == pytest.approx(0.2, abs=0.1)
    # An allocator may give some memory again.
    assert after.memory - before.memory > 0.8 * SIZE
    assert after.peak >= after.memory - 1e6
    assert Usage.now().memory < after.memory - 0.8 * SIZE


@pytest.mark.skipif(not CAN_COPY, reason="a process cannot be copied here")
def test_copies_count_while_they_work_and_after():
    before = Usage.now()
    with Copies(2).crew(None) as crew:
        processes = set(crew.map(_work, [0.3, 0.3]))
        during = Usage.now()
    after = Usage.now()
    _held.clear()
    assert len(processes) == 2
    for usage in (during, after):
        assert usage.cpu_seconds - before.cpu_seconds == pytest.approx(0.6, abs=0.2)
    # What the copy shares with this process counts once.
    assert 1.8 * SIZE < during.memory - before.memory < 2.5 * SIZE
    assert during.memory - after.memory > 0.8 * SIZE
