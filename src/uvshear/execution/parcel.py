"""Objects on their way to other machines: pickled once, and unpickled once wherever they arrive."""

import pickle
from collections.abc import Sequence
from threading import Lock
from typing import Any


class Parcel:
    """A pickled object.

    Arrays are neither copied when the object is packed nor when it is unpacked: they share their memory with the
    parcel. A parcel that is sent on from machine to machine is not pickled again.

    Parameters
    ----------
    pickled
        The pickled object, without its arrays.
    buffers
        Memory of the arrays.
    """

    def __init__(self, pickled: bytes, buffers: Sequence[Any]) -> None:
        self._pickled, self._buffers = pickled, buffers
        self._unpacked: list[Any] = []
        self._lock = Lock()

    @classmethod
    def packed(cls, content: Any) -> "Parcel":
        """Pack an object."""
        buffers: list[pickle.PickleBuffer] = []
        pickled = pickle.dumps(content, 5, buffer_callback=buffers.append)
        return cls(pickled, [buffer.raw() for buffer in buffers])

    def content(self) -> Any:
        """Return the object; it is the same for all that ask on one machine."""
        with self._lock:
            if not self._unpacked:
                self._unpacked.append(pickle.loads(self._pickled, buffers=self._buffers))
            return self._unpacked[0]

    def copy(self) -> Any:
        """Return a copy of the object, which shares no memory with the parcel."""
        return pickle.loads(self._pickled, buffers=[bytearray(each) for each in self._buffers])

    def __sizeof__(self) -> int:
        return len(self._pickled) + sum(memoryview(each).nbytes for each in self._buffers)

    def __reduce__(self) -> tuple[Any, ...]:
        return Parcel, (self._pickled, [pickle.PickleBuffer(each) for each in self._buffers])
