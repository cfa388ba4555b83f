"""Values that are worked out once, whichever of several threads asks for them first."""

from collections.abc import Callable, Hashable
from threading import Lock
from typing import Generic, TypeVar

Value = TypeVar("Value")


class KeptOnce(Generic[Value]):
    """A cache that threads share; it travels between processes with what it holds."""

    def __init__(self) -> None:
        self._known: dict[Hashable, Value] = {}
        self._lock = Lock()

    def __len__(self) -> int:
        return len(self._known)

    def value(self, key: Hashable, work_out: Callable[[], Value]) -> Value:
        """Return the value of a key; it is worked out if nobody has asked for it before."""
        with self._lock:
            if key not in self._known:
                self._known[key] = work_out()
            return self._known[key]

    def __getstate__(self) -> tuple[dict[Hashable, Value]]:
        """Leave out the lock, which belongs to a process."""
        return (self._known,)

    def __setstate__(self, state: tuple[dict[Hashable, Value]]) -> None:
        """Take a lock of its own."""
        (self._known,) = state
        self._lock = Lock()
