"""A value that several tasks use: the first of them works it out, and the last one releases it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Generic, TypeVar

Value = TypeVar("Value")


class UsedValue(Generic[Value]):
    """A value with a known number of uses.

    It does not hold the function that works it out: that of an object which holds the value would tie the two together,
    and their memory would stay occupied until the garbage collector looked at them.
    """

    def __init__(self) -> None:
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
    def used(self, work_out: Callable[[], Value]) -> Iterator[Value]:
        """Yield the value for one use; after the last one it is released.

        ``work_out`` returns the value. It is called when the value is first used; other users wait meanwhile.
        """
        with self._lock:
            if not self._known:
                self._known.append(work_out())
            (value,) = self._known
        yield value
        with self._lock:
            self._uses -= 1
            if self._uses == 0:
                self._known.clear()
