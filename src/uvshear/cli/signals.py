"""Signals that ask the program to end."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Final

ENDING: Final = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU)
"""Ctrl-C, the end of a job in a batch system, the loss of the terminal, and the limit of computing time."""


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
def ending_signals(told: Callable[[EndRequest], object]) -> Iterator[None]:
    """Pass requests to end to a function within the block; those that the caller ignores stay ignored.

    Parameters
    ----------
    told
        Function that may be called at any time in the main thread.
    """

    def tell(number: int, frame: FrameType | None) -> None:
        del frame
        told(EndRequest(number))

    # Only the main thread of a program can handle signals.
    is_main = threading.current_thread() is threading.main_thread()
    heeded = [each for each in ENDING if is_main and signal.getsignal(each) != signal.SIG_IGN]
    before = {number: signal.signal(number, tell) for number in heeded}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
