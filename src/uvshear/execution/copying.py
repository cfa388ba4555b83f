"""Copies of this process, which see all its memory as it is when they are made."""

import ctypes
import os
import signal
import sys
import warnings
from typing import Final

CAN_COPY: Final = sys.platform == "linux"
"""Whether this process can be copied. On other systems than Linux, system libraries may fail in a forked process whose
parent has threads."""

_PR_SET_PDEATHSIG: Final = 1


def copy_process() -> int:
    """Fork this process, and return the process id of the copy, or 0 in the copy.

    The copy is killed when this process ends. It must end by ``os._exit``.
    """
    parent = os.getpid()
    with warnings.catch_warnings():
        # Python warns that another thread may hold a lock when the process is forked. The copies start no threads.
        warnings.simplefilter("ignore")
        copy = os.fork()
    if copy == 0:
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)  # the parent ended before prctl took effect
    return copy
