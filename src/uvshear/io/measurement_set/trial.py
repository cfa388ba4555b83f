"""A trial of a Measurement Set in a process of its own: some damaged tables end the process that opens them.

casacore trusts the numbers that it finds in a table. Wrong ones make it write beyond its memory, or wait for ever.
"""

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from uvshear.errors import InputError
from uvshear.execution import CAN_COPY, copy_process
from uvshear.io.measurement_set.termination import be_silent

LONGEST: Final = 120.0
"""Time after which casacore is taken not to return [s]."""

PAUSE: Final = 0.002
"""Time between two looks at the other process [s]; it usually takes ten times as long."""


@contextmanager
def trial(path: Path, read: Callable[[], object]) -> Iterator[Callable[[], None]]:
    """Begin to try a set, and yield a function that waits for the result.

    The function refuses a set that casacore cannot read without ending the process. Errors that casacore raises are
    left to those who read the set. The trial needs a copy of this process, which only Linux makes safely beside other
    threads; elsewhere there is none. It does not outlast the block.

    Parameters
    ----------
    path
        Path of the set.
    read
        Function that reads a little of it.
    """
    if not CAN_COPY or not (path / "table.dat").is_file():
        yield lambda: None
        return
    child = copy_process()
    if child == 0:
        _try(read)
    statuses: list[int | None] = []

    def wait() -> None:
        statuses.append(_status(child))
        if statuses[0] != 0:
            raise InputError(
                f"{path}: is damaged; casacore {_reason(statuses[0])} when it read the set"
            )

    try:
        yield wait
    finally:
        if not statuses:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)


def check_by_trial(path: Path, read: Callable[[], object]) -> None:
    """Refuse a set that casacore cannot read without ending the process."""
    with trial(path, read) as wait:
        wait()


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


def _reason(status: int | None) -> str:
    if status is None:
        return f"did not return within {LONGEST:.0f} s"
    ending = f"status {os.WEXITSTATUS(status)}"
    if os.WIFSIGNALED(status):
        ending = signal.Signals(os.WTERMSIG(status)).name
    return f"ended the process ({ending})"


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
