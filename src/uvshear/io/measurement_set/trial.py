"""A trial of a Measurement Set in a process of its own: some damaged tables end the process that opens them.

casacore trusts the numbers that it finds in a table. Wrong ones make it write beyond its memory, or wait for ever.
"""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

from uvshear.errors import InputError
from uvshear.execution import CAN_COPY, copy_process
from uvshear.io.measurement_set.termination import be_silent

LONGEST: Final = 120.0
"""Time after which casacore is taken not to return [s]."""

PAUSE: Final = 0.002
"""Time between two looks at the other process [s]; it usually takes ten times as long."""


def check_by_trial(path: Path, read: Callable[[], object]) -> None:
    """Refuse a set that casacore cannot read without ending the process.

    Errors that casacore raises are left to those who read the set. The trial needs a copy of this process, which only
    Linux makes safely beside other threads; elsewhere there is none.

    Parameters
    ----------
    path
        Path of the set.
    read
        Function that reads a little of it.
    """
    if not CAN_COPY or not (path / "table.dat").is_file():
        return
    child = copy_process()
    if child == 0:
        _try(read)
    try:
        status = _status(child)
    except BaseException:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        raise
    if status != 0:
        reason = (
            f"did not return within {LONGEST:.0f} s"
            if status is None
            else f"ended the process ({_ending(status)})"
        )
        raise InputError(f"{path}: is damaged; casacore {reason} when it read the set")


def _status(child: int) -> int | None:
    """Return the status with which a process ends; None if it does not end."""
    end = time.monotonic() + LONGEST
    while True:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return status
        if time.monotonic() > end:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return None
        time.sleep(PAUSE)


def _ending(status: int) -> str:
    if os.WIFSIGNALED(status):
        return signal.Signals(os.WTERMSIG(status)).name
    return f"status {os.WEXITSTATUS(status)}"


def _try(read: Callable[[], object]) -> None:
    """Read, and end this process."""
    try:
        be_silent()
        # What casacore says before the end is of no use.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (1, 2):
            os.dup2(nowhere, stream)
        for number in (signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE):
            signal.signal(number, signal.SIG_DFL)
        read()
    finally:
        os._exit(0)
