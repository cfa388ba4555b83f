"""Handing objects over to copies of this process that already existed when the objects were created."""

import pickle
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from uvshear.execution.shared_memory import common_region, inherited_region
from uvshear.typing import Array

LARGE: Final = 4096
"""Size from which the values of an array do not become part of the pickled object [bytes]."""

_ALIGNMENT: Final = 64


@dataclass(frozen=True)
class _Piece:
    """Bytes of the common region."""

    place: int
    size: int

    def memory(self) -> memoryview:
        """Return the bytes; it is called in a copy."""
        return inherited_region().at(self.place, self.size)


@dataclass(frozen=True)
class HandedOver:
    """An object in the common region, as a copy is told of it.

    Parameters
    ----------
    pickled
        The pickled object without large arrays.
    arrays
        Large arrays, in the order in which the object has them.
    """

    pickled: _Piece
    arrays: Sequence[_Piece]

    def received(self) -> Any:
        """Return the object, in a copy. Its large arrays lie in the common region."""
        return pickle.loads(self.pickled.memory(), buffers=[each.memory() for each in self.arrays])


def hand_over(content: Any) -> tuple[HandedOver, Array]:
    """Place an object in the common region, for all copies.

    Contiguous arrays that lie there already (``shared_zeros``) are shared: all processes see what any of them writes.
    Other large arrays are duplicated once into the region: the duplicates are independent of the originals, and all
    copies of the process share them. Small arrays are pickled.

    Returns
    -------
    HandedOver
        What the copies are told.
    Array
        Memory of the object, which must be kept until all copies have received another one.

    Raises
    ------
    MemoryError
        The region is full.
    Exception
        The object cannot be pickled.
    """
    region = common_region()
    assert region is not None
    buffers: list[Array] = []
    places: list[int | None] = []

    def belongs_to_pickle(buffer: pickle.PickleBuffer) -> bool:
        with memoryview(buffer) as view:
            values = np.frombuffer(buffer.raw(), np.uint8) if view.nbytes else np.zeros(0, np.uint8)
        place = region.place_of(values)
        if place is None and values.nbytes < LARGE:
            return True
        buffers.append(values)
        places.append(place)
        return False

    pickled = pickle.dumps(content, 5, buffer_callback=belongs_to_pickle)
    moved = [np.frombuffer(pickled, np.uint8)]
    moved += [buffer for buffer, place in zip(buffers, places, strict=True) if place is None]
    ends = np.cumsum([-(-len(each) // _ALIGNMENT) * _ALIGNMENT for each in moved]).tolist()
    starts = [0, *ends[:-1]]
    memory = region.zeros(ends[-1])
    for start, each in zip(starts, moved, strict=True):
        memory[start : start + len(each)] = each
    first = region.place_of(memory)
    assert first is not None
    new_places = iter(starts[1:])
    pieces = [
        _Piece(first + next(new_places) if place is None else place, len(buffer))
        for buffer, place in zip(buffers, places, strict=True)
    ]
    return HandedOver(_Piece(first, len(pickled)), pieces), memory
