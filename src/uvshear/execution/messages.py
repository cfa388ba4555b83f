"""Messages between this process and its copies: pickled objects, each after its length."""

import pickle
import socket
import struct
from concurrent.futures import BrokenExecutor
from typing import Any, Final

_LENGTH: Final = struct.Struct("=q")


def packed(content: Any) -> bytes:
    """Return a message."""
    return pickle.dumps(content, pickle.HIGHEST_PROTOCOL)


def send(channel: socket.socket, message: bytes) -> None:
    """Send a message.

    Raises
    ------
    BrokenExecutor
        The other process has ended.
    """
    try:
        channel.sendall(_LENGTH.pack(len(message)) + message)
    except OSError as error:
        raise BrokenExecutor("a copy of the process ended before its work was done") from error


_NOTHING: Final = object()


def received(channel: socket.socket, at_end: Any = _NOTHING) -> Any:
    """Wait for a message, and return its object; ``at_end`` where the other process has ended.

    Raises
    ------
    BrokenExecutor
        The other process has ended, and ``at_end`` is not given.
    """
    head = _exactly(channel, _LENGTH.size)
    if len(head) == _LENGTH.size:
        length = _LENGTH.unpack(head)[0]
        content = _exactly(channel, length)
        if len(content) == length:
            return pickle.loads(content)
    if at_end is _NOTHING:
        raise BrokenExecutor("a copy of the process ended before its work was done")
    return at_end


def _exactly(channel: socket.socket, length: int) -> bytearray:
    content = bytearray(length)
    view, filled = memoryview(content), 0
    while filled < length:
        try:
            count = channel.recv_into(view[filled:], min(length - filled, 1 << 20))
        except ConnectionError:
            count = 0
        if count == 0:
            return bytearray()
        filled += count
    return content
