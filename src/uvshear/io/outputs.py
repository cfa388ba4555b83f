"""Outputs that are written completely or not at all: in a private directory beside the target, then renamed."""

import json
import math
import os
import secrets
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from uvshear.errors import InputError
from uvshear.io.placing import one_at_a_time, place_new, replace
from uvshear.io.reservations import is_reserved, place_of
from uvshear.io.unfinished import is_unfinished, release, unfinished_directory


class NewOutputs:
    """Outputs of one directory that get their names together, when all of them are written.

    Parameters
    ----------
    directory
        Private directory in which they are written, under the names that they will have.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._pending: list[tuple[Path, bool]] = []

    def new(self, path: Path, *, overwrite: bool) -> Path:
        """Return the temporary path of an output; outputs get their names in the order in which this is called."""
        self._pending.append((path, overwrite))
        return self._directory / path.name

    def place(self) -> None:
        """Give all outputs their names; if one cannot get its name, keep the remaining ones, and say where they are."""
        parent = self._directory.parent
        path = parent
        try:
            with one_at_a_time(parent):
                for path, overwrite in self._pending:
                    if not overwrite and os.path.lexists(path):
                        raise FileExistsError
                for path, overwrite in self._pending:
                    (replace if overwrite else place_new)(self._directory / path.name, path)
        except OSError as error:
            reason = error.strerror or str(error)
            if isinstance(error, FileExistsError):
                reason = "it exists now, although it did not when this run began"
            kept = parent / f"{path.name}.kept-{secrets.token_hex(4)}"
            release(self._directory, kept)
            raise InputError(
                f"{path}: cannot be put in place: {reason}; what was to be written is in the directory {kept}"
            ) from error


@contextmanager
def new_outputs(beside: Path) -> Iterator[NewOutputs]:
    """Yield outputs in the directory of one of them; they get their names if the block ends without an error."""
    try:
        with unfinished_directory(beside) as directory:
            outputs = NewOutputs(directory)
            yield outputs
            outputs.place()
    except OSError as error:
        raise InputError(f"{beside}: cannot be written: {error.strerror or error}") from error


@contextmanager
def new_file(path: Path, *, overwrite: bool = False) -> Iterator[Path]:
    """Yield a temporary path to write to, which becomes ``path`` if the block ends without an error."""
    if is_unfinished(path):
        yield path  # one of several outputs, which get their names together
        return
    check_file(path, overwrite=overwrite)
    with new_outputs(path) as outputs:
        yield outputs.new(path, overwrite=overwrite)


def check_output(path: Path, *, overwrite: bool) -> None:
    """Refuse a target that cannot be written, before anything is computed for it."""
    _check_parent(path)
    if os.path.lexists(path) and not overwrite and not is_reserved(path):
        raise InputError(
            f"{path}: exists already; give --overwrite (overwrite=True) or another name"
        )


def check_file(path: Path, *, overwrite: bool) -> None:
    """Refuse a target that cannot be written as a file, before anything is computed for it."""
    check_output(path, overwrite=overwrite)
    if path.is_dir():
        raise InputError(f"{path}: is a directory; give the name of a file")
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: is not an ordinary file, and will not be replaced by one")


def check_apart(outputs: Sequence[Path], inputs: Sequence[Path]) -> None:
    """Refuse outputs that are given twice, that are inputs, that lie within an input, or that contain one."""
    places = [place_of(path) for path in outputs]
    for number, place in enumerate(places):
        if place in places[:number]:
            raise InputError(f"{outputs[number]}: would be written twice; give two names")
    existing = [path for path in inputs if path.exists()]
    for path, place in zip(outputs, places, strict=True):
        for source in existing:
            known = source.resolve()
            if path.exists() and path.samefile(source):
                raise InputError(f"{path}: is an input too; give another name for the output")
            if known in place.parents and _is_data(known):
                raise InputError(f"{path}: is within the input {source}; give another name")
            if path.resolve() in known.parents:
                raise InputError(f"{path}: contains the input {source}; give another name")


def _is_data(directory: Path) -> bool:
    """Tell whether a directory is a single data set: a Measurement Set or a zarr store."""
    return any((directory / name).is_file() for name in ("table.dat", "zarr.json", ".zgroup"))


def _check_parent(path: Path) -> None:
    parent = path.parent
    if not parent.is_dir():
        what = "is not a directory" if parent.exists() else "does not exist"
        raise InputError(f"{path}: {parent} {what}; give an output in a directory that exists")
    if not os.access(parent, os.W_OK | os.X_OK):
        raise InputError(
            f"{path}: {parent} is not writable; give an output in a directory in which you may write"
        )


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
