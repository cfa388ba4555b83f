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
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def in_threads(count: int = 0) -> Executor:
    """Return an executor with this number of threads; 0 stands for the number of cores."""
    count = count or available_cores()
    return Threads(count) if count > 1 else Serial()


def in_processes(count: int = 0) -> Executor:
    """Return an executor with this number of processes; 0 stands for the number of cores.

    On Linux they are forked copies of this process, which start within milliseconds; elsewhere they are new processes.
    """
    count = count or available_cores()
    if count == 1:
        return Serial()
    return Copies(count) if CAN_COPY else Processes(count)


def in_copies(count: int = 0) -> Executor:
    """Return an executor with this number of copies of this process, or of threads where it cannot be copied.

    It suits tasks that share an object which is too large to be sent to other processes. 0 stands for the number of
    cores.
    """
    count = count or available_cores()
    return Copies(count) if CAN_COPY and count > 1 else in_threads(count)
