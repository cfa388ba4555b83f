"""Outputs that are written completely or not at all: under a temporary name beside the target, then renamed."""

import json
import math
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from uvshear.errors import InputError

_MOST_REMOVALS = 100

_unfinished: set[Path] = set()


@contextmanager
def unfinished(path: Path) -> Iterator[None]:
    """Register ``path`` as unfinished within the block, so that it does not outlive the process."""
    _unfinished.add(path)
    try:
        yield
    finally:
        _unfinished.discard(path)


def remove_unfinished() -> None:
    """Remove all unfinished outputs when a process ends without leaving its blocks."""
    for path in tuple(_unfinished):
        if path.is_dir() and not path.is_symlink():
            # Another thread may still be writing files into the directory.
            for _ in range(_MOST_REMOVALS):
                shutil.rmtree(path, ignore_errors=True)
                if not path.exists():
                    break
        else:
            path.unlink(missing_ok=True)


def check_output(path: Path, *, overwrite: bool) -> None:
    """Refuse a target that cannot be written, before anything is computed for it."""
    _check_place(path)
    if os.path.lexists(path) and not overwrite:
        raise InputError(
            f"{path}: exists already; give --overwrite (overwrite=True) or another name"
        )


def check_file(path: Path, *, overwrite: bool, inputs: Sequence[Path] = ()) -> None:
    """Refuse a target that cannot be written as a file, or that is an input, before anything is computed for it."""
    check_output(path, overwrite=overwrite)
    if path.exists() and any(path.samefile(file) for file in inputs if file.exists()):
        raise InputError(f"{path}: is an input too; give another name for the output")
    if path.is_dir():
        raise InputError(f"{path}: is a directory; give the name of a file")


def _check_place(path: Path) -> None:
    parent = path.parent
    if not parent.is_dir():
        what = "is not a directory" if parent.exists() else "does not exist"
        raise InputError(f"{path}: {parent} {what}; give an output in a directory that exists")
    if not os.access(parent, os.W_OK | os.X_OK):
        raise InputError(
            f"{path}: {parent} is not writable; give an output in a directory in which you may write"
        )


@contextmanager
def new_file(path: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """Yield a temporary name to write to, which becomes ``path`` if the block ends without an error."""
    check_file(path, overwrite=overwrite)
    # The name is hidden, and its suffix tells writers the format.
    temporary = path.with_name(f".{path.stem}.partial-{os.getpid()}{path.suffix}")
    try:
        with unfinished(temporary):
            yield temporary
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)


def write_json(path: Path, values: Mapping[str, object], *, overwrite: bool = False) -> None:
    """Write a record, nested or not; numbers that are not finite become null, as JSON has no other form for them."""

    def finite(value: object) -> object:
        if isinstance(value, Mapping):
            return {name: finite(item) for name, item in value.items()}
        if isinstance(value, list | tuple):
            return [finite(item) for item in value]
        return None if isinstance(value, float) and not math.isfinite(value) else value

    record = finite(values)
    with new_file(path, overwrite=overwrite) as temporary:
        temporary.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")
