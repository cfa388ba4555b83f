"""Standard output and standard error, which may be closed, full, a broken pipe, or unable to encode a character."""

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from typing import Any, Final

STANDARD: Final = 2
"""Number of standard error, the last of the standard streams."""


def open_closed_descriptors() -> None:
    """Open the standard streams that the caller has closed on the null device.

    Otherwise the first files that are opened get their numbers, and libraries would write messages into these files.
    """
    descriptor = os.open(os.devnull, os.O_RDWR)
    while descriptor <= STANDARD:
        descriptor = os.open(os.devnull, os.O_RDWR)
    os.close(descriptor)


class StandardStream:
    """A stream on which nothing that is written can end the run.

    What cannot be encoded is written as an escape. Where nothing can be written any more, all that follows is dropped.

    Parameters
    ----------
    stream
        Stream of text that is written to, of any kind; None if it was closed when the program started.

    Attributes
    ----------
    lost
        Why a result did not reach the stream; None if every result did.
    """

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._failure = None if stream is not None else OSError(errno.EBADF, "is closed")
        self.lost: OSError | None = None

    def write(self, text: str) -> int:
        """Write a part of the result."""
        self.remark(text)
        self.lost = self._failure
        return len(text)

    def remark(self, text: str) -> None:
        """Write something that is no part of the result."""
        if self._stream is None or self._failure is not None:
            return
        try:
            self._stream.write(_encodable(text, self.encoding, self.errors))
            self._stream.flush()
        except (OSError, ValueError) as error:
            self._fail(error)

    def flush(self) -> None:
        """Do nothing: everything is written at once."""

    def writable(self) -> bool:
        """Return that something can be written."""
        return True

    def isatty(self) -> bool:
        """Tell whether the stream is a terminal."""
        try:
            return self._stream is not None and self._stream.isatty()
        except ValueError:  # it was closed later
            return False

    def fileno(self) -> int:
        """Return the number of the descriptor."""
        if self._stream is None:
            raise OSError(errno.EBADF, "is closed")
        return self._stream.fileno()

    @property
    def encoding(self) -> str:
        """Encoding of the stream."""
        return getattr(self._stream, "encoding", None) or "utf-8"

    @property
    def errors(self) -> str:
        """Treatment of characters that the encoding lacks."""
        return getattr(self._stream, "errors", None) or "strict"

    def _fail(self, error: OSError | ValueError) -> None:
        self._failure = error if isinstance(error, OSError) else OSError(errno.EBADF, "is closed")
        # Otherwise the interpreter would try to write the rest when it ends, and fail.
        with suppress(OSError, ValueError):
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, self.fileno())
            os.close(null)


def _encodable(text: str, encoding: str, errors: str) -> str:
    try:
        text.encode(encoding, errors)
    except UnicodeEncodeError:
        return text.encode(encoding, "backslashreplace").decode(encoding)
    return text


@contextmanager
def standard_streams() -> Iterator[StandardStream]:
    """Replace standard output and standard error within the block, and yield the output."""
    output = StandardStream(sys.stdout)
    with redirect_stdout(output), redirect_stderr(StandardStream(sys.stderr)):
        yield output
