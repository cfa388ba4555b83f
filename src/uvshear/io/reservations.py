"""Outputs that a process has reserved, so that no other process begins to write them."""

import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Final

from uvshear.errors import InputError
from uvshear.io.placing import one_at_a_time
from uvshear.io.unfinished import live_directories, unfinished_directory

_NAMES: Final = "names"
"""File of a private directory with the names of the outputs that its process has reserved."""

_reserved: set[Path] = set()
"""Outputs that this process has reserved."""


def place_of(path: Path) -> Path:
    """Return the absolute path of an output; links in it are resolved, unless the output itself is one."""
    return path.parent.resolve() / path.name


def is_reserved(path: Path) -> bool:
    """Tell whether this process has reserved an output."""
    return place_of(path) in _reserved


@contextmanager
def reserved(outputs: Sequence[Path]) -> Iterator[None]:
    """Keep other processes from beginning to write the same outputs during the block.

    If a file with the name of an output has nevertheless appeared by the end of the block, and is not to be replaced,
    it stays as it is; what was to be written is kept beside it.
    """
    places = {place_of(path): path for path in outputs}
    with ExitStack() as stack:
        for parent in {place.parent for place in places}:
            names = {place.name for place in places if place.parent == parent}
            try:
                stack.enter_context(_announced(parent, names))
            except OSError as error:
                some = next(path for place, path in places.items() if place.parent == parent)
                raise InputError(f"{some}: cannot be written: {error.strerror or error}") from error
        mine = places.keys() - _reserved
        _reserved.update(mine)
        stack.callback(_reserved.difference_update, mine)
        yield


@contextmanager
def _announced(parent: Path, names: set[str]) -> Iterator[None]:
    with ExitStack() as stack:
        with one_at_a_time(parent):
            for other in live_directories(parent):
                if taken := sorted(names & _names(other)):
                    raise InputError(
                        f"{parent / taken[0]}: another process is at work on it; wait until that process has ended, or"
                        " give another name"
                    )
            directory = stack.enter_context(unfinished_directory(parent / min(names)))
            (directory / _NAMES).write_text(json.dumps(sorted(names)), encoding="utf-8")
        yield


def _names(directory: Path) -> set[str]:
    try:
        return set(map(str, json.loads((directory / _NAMES).read_text(encoding="utf-8"))))
    except (OSError, ValueError, TypeError):
        return set()  # it reserves none
