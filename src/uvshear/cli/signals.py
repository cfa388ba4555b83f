"""Signals that ask the program to end."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Final

ENDING: Final = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU)
"""Signals of Ctrl-C, of a batch system that ends a job, of a lost terminal, and of the limit of CPU time."""


@dataclass(frozen=True)
class EndRequest:
    """A request to end.

    Parameters
    ----------
    number
        Number of the signal.
    """

    number: int

    @property
    def status(self) -> int:
        """Exit status of a program that a signal ends, as shells show it."""
        return 128 + self.number


@contextmanager
def ending_signals(report: Callable[[EndRequest], object]) -> Iterator[None]:
    """Within the block, report signals that ask the program to end.

    Signals that were ignored when the program was started, as with ``nohup``, stay ignored.

    Parameters
    ----------
    report
        Function that is called with each request, in the main thread and between any two instructions.
    """

    def tell(number: int, frame: FrameType | None) -> None:
        del frame
        report(EndRequest(number))

    # Only the main thread of a program can handle signals.
    is_main = threading.current_thread() is threading.main_thread()
    handled = [each for each in ENDING if is_main and signal.getsignal(each) != signal.SIG_IGN]
    before = {number: signal.signal(number, tell) for number in handled}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
