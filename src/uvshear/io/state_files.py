"""Files with one Python object each, whose checksums tell whether they are whole.

An object is pickled, because the state of a measurement may hold objects of the user's own classes. Its large arrays
are written as they are, so that neither writing nor reading duplicates them. Reading such a file may run any code;
``checkpoint`` therefore first checks that the file belongs to this user.
"""

import os
import pickle
import struct
import zlib
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np

_MAGIC: Final = b"uvshear state 1\n"

_ALIGNMENT: Final = 64
"""Alignment of arrays in a file [bytes], with which calculations on them give the same bits as on new arrays."""

_PIECE: Final = struct.Struct("<QI")
"""Length and checksum of each piece of a file."""

_COUNT: Final = struct.Struct("<II")
"""Number of the pieces, and checksum of their list."""


class DamagedError(Exception):
    """A file is not what was written."""


def write_state(path: Path, state: Any) -> None:
    """Write an object to a new file, which gets its name only when it is complete."""
    # The process may be killed now; another name belongs to no state.
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with unfinished.open("wb") as file:
            _write(file, state)
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def read_state(path: Path) -> Any:
    """Return the object in a file.

    Raises
    ------
    DamagedError
        The file was not written by :func:`write_state`, or was changed since, or its classes have changed.
    """
    pickled, *buffers = _pieces(path)
    try:
        return pickle.loads(pickled, buffers=buffers)
    except Exception as error:
        raise DamagedError(f"{type(error).__name__}: {error}") from error


def check_state(path: Path) -> None:
    """Raise ``DamagedError`` if a file is not as it was written; its content is not interpreted."""
    _pieces(path)


def _write(file: BinaryIO, state: Any) -> None:
    buffers: list[pickle.PickleBuffer] = []
    pickled = pickle.dumps(state, 5, buffer_callback=buffers.append)
    pieces = [memoryview(pickled), *(buffer.raw() for buffer in buffers)]
    entries = b"".join(_PIECE.pack(len(piece), zlib.crc32(piece)) for piece in pieces)
    file.write(_MAGIC + _COUNT.pack(len(pieces), zlib.crc32(entries)) + entries)
    for piece in pieces:
        file.write(bytes(-file.tell() % _ALIGNMENT))
        file.write(piece)


def _pieces(path: Path) -> list[memoryview]:
    # Unlike bytes, an array can be written to by the one who gets it.
    content = np.fromfile(path, np.uint8).data
    start = len(_MAGIC) + _COUNT.size
    head = content[:start].tobytes()
    if len(head) < start or not head.startswith(_MAGIC):
        raise DamagedError("it does not begin as it should")
    count, checksum = _COUNT.unpack(head[len(_MAGIC) :])
    end = start + count * _PIECE.size
    entries = content[start:end].tobytes()
    if zlib.crc32(entries) != checksum or count == 0:
        raise DamagedError("its table of contents is damaged")
    pieces = []
    for length, expected in _PIECE.iter_unpack(entries):
        first = end + -end % _ALIGNMENT
        end = first + length
        piece = content[first:end]
        if len(piece) != length or zlib.crc32(piece) != expected:
            raise DamagedError("a checksum is wrong")
        pieces.append(piece)
    return pieces
