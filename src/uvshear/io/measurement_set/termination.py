"""The end of the process by casacore: on some damaged tables it neither returns nor raises, but terminates.

An exception that C++ code throws where none is allowed ends the process by ``std::terminate``. Nothing can go on
afterwards, but a handler can say why, in place of C++'s "terminate called without an active exception".
"""

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import Any, Final

from uvshear.io.unfinished import remove_unfinished

STATUS: Final = 2
"""Exit status, that of a wrong input."""

_SET_TERMINATE: Final = "_ZSt13set_terminatePFvvE"
"""``std::set_terminate`` as the linker knows it."""

_HANDLER: Final = ctypes.CFUNCTYPE(None)

_reading: ContextVar[str | None] = ContextVar("_reading", default=None)
"""What this thread reads with casacore."""


_is_silent: ContextVar[bool] = ContextVar("_is_silent", default=False)
"""Whether another process tells why this one ends."""


def be_silent() -> None:
    """Let this process end without a word, and without the removal of files, which are another's."""
    _is_silent.set(True)


@contextmanager
def told_if_terminated(path: Path, what: str) -> Iterator[None]:
    """If the block terminates the process, write one line to standard error and end with status 2.

    Parameters
    ----------
    path
        Path of the set that is read.
    what
        Part of it that is read.
    """
    _install()
    # A token could not be reset where a generator that reads is closed in another context, as in notebooks.
    before = _reading.get()
    _reading.set(f"{path}: {what}")
    try:
        yield
    finally:
        _reading.set(before)


@cache
def _install() -> tuple[Any, ...]:
    """Install the handler for the life of the process, and return what must live as long."""
    try:
        set_terminate = ctypes.CDLL("libstdc++.so.6")[_SET_TERMINATE]
    except (OSError, AttributeError):
        return ()  # the library of C++ has another name here
    set_terminate.argtypes, set_terminate.restype = (_HANDLER,), ctypes.c_void_p

    def tell() -> None:
        if (read := _reading.get()) is None or _is_silent.get():
            # Another library is the cause; what it had installed is to answer.
            if earlier:
                _HANDLER(earlier[0])()
            os.abort()
        line = f"uvshear: error: {read} cannot be read; it is damaged, and casacore gave up\n"
        os.write(2, line.encode(errors="backslashreplace"))
        remove_unfinished()
        os._exit(STATUS)

    handler, earlier = _HANDLER(tell), []
    if (address := set_terminate(handler)) is not None:
        earlier.append(address)
    return handler, set_terminate
