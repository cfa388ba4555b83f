"""Private directories in which outputs are written before they get their names, and the removal of abandoned ones.

A directory is beside the output, so that a finished file can be renamed to its place. Its name is random and only its
owner may enter it: nobody can guess the path of a file in it, or put a link there. The process that owns a directory
holds a lock on a file in it. The system releases this lock when the process ends, however it ends. A directory without
an owner is recognised by this, and the next process that writes beside it removes it.
"""

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

MARK: Final = ".uvshear-unfinished-"
"""Part of the names of private directories, after a dot and the name of an output."""

_LONGEST: Final = 100
"""Largest number of characters of an output's name that the name of its private directory repeats."""

_LOCK: Final = "lock"

_MOST_REMOVALS: Final = 100
"""Attempts at removing a directory in which another thread may still be making files."""

_owned: dict[Path, int | None] = {}
"""Directories of this process, with the descriptors of their locks; None on a file system without locks."""


@contextmanager
def unfinished_directory(output: Path) -> Iterator[Path]:
    """Yield a new private directory beside an output; unless released, it is removed at the end of the block.

    Directories that killed processes left there are removed.
    """
    remove_leftovers(output.parent)
    directory = _new(output)
    try:
        yield directory
    finally:
        _remove(directory)


def is_unfinished(path: Path) -> bool:
    """Tell whether a path is directly in a private directory of this process."""
    return path.parent in _owned


def remove_unfinished() -> None:
    """Remove all private directories of this process, for an exit that does not leave the blocks that use them."""
    for directory in tuple(_owned):
        _remove(directory)


def release(directory: Path, name: Path) -> None:
    """Rename a private directory to a visible name, under which it stays."""
    directory.rename(name)
    (name / _LOCK).unlink(missing_ok=True)
    _forget(directory)


def live_directories(parent: Path) -> Iterator[Path]:
    """Yield the private directories of other processes that are alive."""
    for directory in _found(parent):
        if directory not in _owned:
            try:
                lock = _locked(directory)
            except OSError:
                continue
            if lock is None:
                yield directory
            else:
                os.close(lock)


def remove_leftovers(parent: Path) -> None:
    """Remove the private directories of processes that have ended; what cannot be removed is left."""
    for directory in _found(parent):
        if directory in _owned:
            continue
        try:
            lock = _locked(directory)
        except OSError:  # the file system has no locks, or another process has removed it
            continue
        if lock is not None:
            _owned[directory] = lock
            _remove(directory)


def _found(parent: Path) -> list[Path]:
    """Return the private directories of this user."""
    found = []
    with suppress(OSError), os.scandir(parent.resolve()) as entries:
        for entry in entries:
            if (
                entry.name.startswith(".")
                and MARK in entry.name
                and entry.is_dir(follow_symlinks=False)
            ):
                with suppress(OSError):
                    if entry.stat(follow_symlinks=False).st_uid == os.geteuid():
                        found.append(Path(entry.path))
    return found


def _new(output: Path) -> Path:
    prefix = f".{output.name[:_LONGEST]}{MARK}"
    while True:
        directory = Path(tempfile.mkdtemp(prefix=prefix, dir=output.parent.resolve()))
        try:
            lock = _locked(directory)
        except FileNotFoundError:
            continue  # another process took it for a leftover before it was locked
        except OSError:
            _owned[directory] = None
            return directory
        if lock is not None:
            _owned[directory] = lock
            return directory


def _locked(directory: Path) -> int | None:
    """Lock a directory, and return the descriptor of the lock; None if another process holds it."""
    path = directory / _LOCK
    lock = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        # A process that held the lock before may have removed the file in the meantime.
        if not os.path.samestat(os.fstat(lock), path.stat()):
            raise FileNotFoundError(path)
    except BlockingIOError:
        os.close(lock)
        return None
    except OSError:
        os.close(lock)
        raise
    return lock


def _remove(directory: Path) -> None:
    for _ in range(_MOST_REMOVALS):
        # The lock is removed last, so that another process can complete a removal that was cut short.
        for entry in _entries(directory):
            if entry.name != _LOCK:
                if entry.is_dir(follow_symlinks=False):
                    shutil.rmtree(entry.path, ignore_errors=True)
                else:
                    with suppress(OSError):
                        os.unlink(entry.path)
        with suppress(OSError):
            (directory / _LOCK).unlink(missing_ok=True)
            directory.rmdir()
        if not os.path.lexists(directory):
            break
    _forget(directory)


def _entries(directory: Path) -> list["os.DirEntry[str]"]:
    try:
        with os.scandir(directory) as entries:
            return list(entries)
    except OSError:
        return []


def _forget(directory: Path) -> None:
    lock = _owned.pop(directory, None)
    if lock is not None:
        os.close(lock)
