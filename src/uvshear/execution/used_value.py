"""A value that several tasks use: the first of them works it out, and the last one releases it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Generic, TypeVar

Value = TypeVar("Value")


class UsedValue(Generic[Value]):
    """A value with a known number of uses.

    Parameters
    ----------
    work_out
        Function that returns the value. It is called when the value is first used; other users wait meanwhile.
    """

    def __init__(self, work_out: Callable[[], Value]) -> None:
        self._work_out = work_out
        self._lock, self._uses = Lock(), 0
        self._known: list[Value] = []

    @property
    def is_held(self) -> bool:
        """Whether the value is in memory."""
        return bool(self._known)

    def announce_use(self) -> None:
        """Announce one more use, before the first one begins."""
        self._uses += 1

    @contextmanager
    def used(self) -> Iterator[Value]:
        """Yield the value for one use; after the last one it is released."""
        with self._lock:
            if not self._known:
                self._known.append(self._work_out())
            (value,) = self._known
        yield value
        with self._lock:
            self._uses -= 1
            if self._uses == 0:
                self._known.clear()
