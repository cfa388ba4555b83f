"""Number of cores, and executors with as many workers."""

import os

from uvshear.execution.copies import Copies
from uvshear.execution.copying import CAN_COPY
from uvshear.execution.executor import Executor
from uvshear.execution.processes import Processes
from uvshear.execution.serial import Serial
from uvshear.execution.threads import Threads


def available_cores() -> int:
    """Count the cores that this process may use."""
    return len(os.sched_getaffinity(0))


def in_threads(count: int = 0) -> Executor:
    """Return an executor with this number of threads; 0 stands for the number of cores."""
    count = count or available_cores()
    return Threads(count) if count > 1 else Serial()


def in_processes(count: int = 0) -> Executor:
    """Return an executor with this number of processes; 0 stands for the number of cores.

    They are copies of this process where there can be any, since these start at once.
    """
    count = count or available_cores()
    if count == 1:
        return Serial()
    return Copies(count) if CAN_COPY else Processes(count)


def in_copies(count: int = 0) -> Executor:
    """Return an executor with this number of copies of this process, or of threads where it cannot be copied.

    What tasks share may be too large to be sent. 0 stands for the number of cores.
    """
    count = count or available_cores()
    return Copies(count) if CAN_COPY and count > 1 else in_threads(count)
