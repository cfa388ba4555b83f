"""Values that are worked out once, whichever of several threads asks for them first."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Generic, TypeVar

Value = TypeVar("Value")


class KeptOnce(Generic[Value]):
    """A cache that threads share; it travels between processes with what it holds.

    Parameters
    ----------
    most
        Largest number of values that are kept: the one that was not asked for the longest gives way to a new one. A
        value that a thread works with lives on until the thread has done.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._known: OrderedDict[Hashable, Value] = OrderedDict()
        self._lock = Lock()

    def __len__(self) -> int:
        return len(self._known)

    def value(self, key: Hashable, work_out: Callable[[], Value]) -> Value:
        """Return the value of a key; it is worked out if it is not held, by one thread at a time."""
        with self._lock:
            if key not in self._known:
                while len(self._known) >= self._most:
                    self._known.popitem(last=False)
                self._known[key] = work_out()
            self._known.move_to_end(key)
            return self._known[key]

    def __getstate__(self) -> tuple[int, OrderedDict[Hashable, Value]]:
        """Leave out the lock, which belongs to a process."""
        return self._most, self._known

    def __setstate__(self, state: tuple[int, OrderedDict[Hashable, Value]]) -> None:
        """Take a lock of its own."""
        self._most, self._known = state
        self._lock = Lock()
