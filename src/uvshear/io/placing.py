"""Moves of outputs from a temporary name to the final one, without replacing anything by mistake."""

import ctypes
import errno
import fcntl
import os
import secrets
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

_NO_REPLACE, _EXCHANGE = 1, 2
"""Flags of renameat2, from the kernel's linux/fs.h."""

_HERE: Final = -100
"""AT_FDCWD of the kernel's linux/fcntl.h: relative paths begin in the working directory."""

_PATIENCE: Final = 10.0
"""Longest wait for another process to finish its renames [s], which take milliseconds."""


@contextmanager
def one_at_a_time(parent: Path) -> Iterator[None]:
    """Keep other processes of this package from renaming outputs in a directory during the block.

    File systems that cannot lock a directory, such as NFS, give no such protection.
    """
    descriptor = os.open(parent, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        end = time.monotonic() + _PATIENCE
        while True:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                if time.monotonic() < end:
                    time.sleep(0.01)
                    continue
            except OSError:
                pass
            break
        yield
    finally:
        os.close(descriptor)


def place_new(written: Path, target: Path) -> None:
    """Move a file or directory to a name that does not exist; raise FileExistsError if it does."""
    try:
        _rename(written, target, _NO_REPLACE)
    except NotImplementedError:
        if written.is_dir():
            _move_checked(written, target)
            return
        try:
            os.link(written, target)
        except FileExistsError:
            raise
        except OSError:  # a file system without hard links
            _move_checked(written, target)
        else:
            written.unlink()


def replace(written: Path, target: Path) -> None:
    """Move a file or directory to a name, and remove what had that name; at every moment one of the two is complete."""
    if not written.is_dir():
        os.replace(written, target)
        return
    if not os.path.lexists(target):
        place_new(written, target)
        return
    try:
        _rename(written, target, _EXCHANGE)
        return  # the old one is now where the new one was, and is removed with that directory
    except NotImplementedError:
        pass
    # The old one gets a visible name, so that it is not lost if the process is killed here.
    aside = target.with_name(f"{target.name}.replaced-{secrets.token_hex(4)}")
    target.rename(aside)
    try:
        written.rename(target)
    except BaseException:
        with suppress(OSError):
            aside.rename(target)
        raise
    shutil.rmtree(aside, ignore_errors=True)


def _move_checked(written: Path, target: Path) -> None:
    if os.path.lexists(target):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target))
    written.rename(target)


def _rename(source: Path, target: Path, flags: int) -> None:
    """Rename with a flag of Linux; raise NotImplementedError where the system or the file system has none."""
    try:
        function = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError):
        raise NotImplementedError from None
    if function(_HERE, os.fsencode(source), _HERE, os.fsencode(target), ctypes.c_uint(flags)) == 0:
        return
    number = ctypes.get_errno()
    if number in {errno.EINVAL, errno.ENOSYS, errno.ENOTSUP}:
        raise NotImplementedError
    raise OSError(number, os.strerror(number), str(target))
