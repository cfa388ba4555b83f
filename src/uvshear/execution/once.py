"""Values that are worked out once, whichever of several threads asks for them first."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Generic, TypeAlias, TypeVar

Value = TypeVar("Value")

_State: TypeAlias = tuple[float, Callable[[Value], float], OrderedDict[Hashable, Value]]


class KeptOnce(Generic[Value]):
    """A cache that threads share; it travels between processes with what it holds.

    Parameters
    ----------
    memory
        Memory for the values that are kept [bytes]: those that were not asked for the longest give way to a new one.
        The last one is kept whatever its size, and a value that a thread works with lives on until the thread has done.
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
        """Return the value of a key; it is worked out if it is not held, by one thread at a time."""
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
