"""Copies of this process, which see all its memory as it is when they are made."""

import ctypes
import os
import signal
import sys
import warnings
from typing import Final

CAN_COPY: Final = sys.platform == "linux"
"""Whether processes are copied: elsewhere, libraries of the system may not survive it beside other threads."""

_PR_SET_PDEATHSIG: Final = 1


def copy_process() -> int:
    """Copy this process, and return the number of the copy; 0 in the copy, which ends with this process at the latest.

    The copy must end by ``os._exit``.
    """
    parent = os.getpid()
    with warnings.catch_warnings():
        # Python warns of the locks of other threads, which a copy might find held; it starts no threads.
        warnings.simplefilter("ignore")
        copy = os.fork()
    if copy == 0:
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)  # it has ended before that
    return copy
