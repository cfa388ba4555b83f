"""A cache that threads share, in which no two threads compute the same value at the same time."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Generic, TypeAlias, TypeVar

Value = TypeVar("Value")

_State: TypeAlias = tuple[float, Callable[[Value], float], OrderedDict[Hashable, Value]]


class KeptOnce(Generic[Value]):
    """A cache that threads share, and that can be pickled with its values.

    Parameters
    ----------
    memory
        Memory for the values [bytes]. Where a new value exceeds it, the least recently used values are dropped; the
        newest is kept whatever its size. A dropped value lives on while a caller uses it, and is computed again when it
        is next requested.
    size_of
        Function that returns the size of a value [bytes].
    """

    def __init__(self, memory: float, size_of: Callable[[Value], float]) -> None:
        self._memory, self._size_of = memory, size_of
        self._known: OrderedDict[Hashable, Value] = OrderedDict()
        self._lock = Lock()

    def __len__(self) -> int:
        return len(self._known)

    def value(self, key: Hashable, work_out: Callable[[], Value]) -> Value:
        """Return the value of a key, and compute it first if it is not held; one thread computes at a time."""
        with self._lock:
            if key not in self._known:
                self._known[key] = work_out()
                held = sum(map(self._size_of, self._known.values()))
                while held > self._memory and len(self._known) > 1:
                    _, oldest = self._known.popitem(last=False)
                    held -= self._size_of(oldest)
            self._known.move_to_end(key)
            return self._known[key]

    def __getstate__(self) -> _State[Value]:
        """Leave out the lock, which belongs to a process."""
        return self._memory, self._size_of, self._known

    def __setstate__(self, state: _State[Value]) -> None:
        """Take a lock of its own."""
        self._memory, self._size_of, self._known = state
        self._lock = Lock()
