"""The checkpoint of a measurement: a directory beside its output with the states from which another run can go on.

It has a file that says what the measurement is, and one for each state (``state_files``). The directory gets its name
when the first file is in it, and goes when the results have been written.
"""

import json
import os
import shutil
import time
import warnings
from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from typing import Any, Final, Self

from uvshear.errors import CheckpointWarning, InputError
from uvshear.extraction.state_store import Results, StateStore
from uvshear.io.run_identity import companion
from uvshear.io.state_files import DamagedError, check_state, read_state, write_state
from uvshear.io.unfinished import unfinished_directory

EVERY: Final = 60.0
"""Work that may be lost [s]: results that were found since are stored after this time."""

_ABOUT: Final = "about.json"
_MEASUREMENT, _CONTENT = "measurement", "content"
_STATE: Final = ".state"
_RESULTS: Final = ".results"

_in_use: list["CheckpointStore"] = []
"""The stores of this process that are in use, or that a measurement which has failed has left."""


@dataclass(frozen=True)
class Checkpoint:
    """Where a measurement stores its state while it runs, and whether it goes on from what is there.

    Parameters
    ----------
    path
        Directory of the checkpoint, which is made.
    resumes
        Whether the measurement goes on from the state that is there. Otherwise a checkpoint that is there is removed.
    options
        Options that the state depends on, by their names, in addition to what the measurement knows of itself.
    """

    path: str | Path
    resumes: bool = False
    options: Mapping[str, object] = field(default_factory=dict)

    @property
    def directory(self) -> Path:
        """The directory as a path."""
        return Path(self.path)

    def opened(self, identity: Mapping[str, str]) -> "CheckpointStore":
        """Check what is there, and return the store; nothing is changed until it is begun.

        Parameters
        ----------
        identity
            What the state depends on: names that a user understands, and values.

        Raises
        ------
        InputError
            Something else has the name of the checkpoint, or the checkpoint is damaged, belongs to another user or to
            another measurement.
        """
        directory = self.directory
        named = {name: str(value) for name, value in self.options.items()} | dict(identity)
        is_there = os.path.lexists(directory)
        if is_there:
            _check_kind(directory)
        is_resumed = self.resumes and is_there
        if is_resumed:
            _check_same(directory, _read_about(directory)[_MEASUREMENT], named)
            _check_states(directory)
        elif self.resumes:
            _warn(f"{directory}: there is no checkpoint; the measurement begins anew")
        return CheckpointStore(directory, named, is_resumed=is_resumed)


class CheckpointStore(StateStore):
    """The states of one measurement.

    Parameters
    ----------
    directory
        Directory of the checkpoint.
    identity
        What the states depend on.
    is_resumed
        Whether the states that are there are used.
    """

    def __init__(self, directory: Path, identity: Mapping[str, str], *, is_resumed: bool) -> None:
        self.directory = directory
        self._identity, self._is_resumed = dict(identity), is_resumed
        self._results: list[_StoredResults] = []
        self._saved = time.monotonic()
        self._has_failed = False

    @property
    def has_state(self) -> bool:
        """Whether a state has been stored."""
        return bool(self._files(_STATE))

    @property
    def is_due(self) -> bool:
        """Whether nothing has been saved for ``EVERY`` seconds."""
        return time.monotonic() - self._saved > EVERY

    @contextmanager
    def in_use(self, content: Mapping[str, str]) -> Iterator[None]:
        """Use the checkpoint during the block, after which it stays until it is removed.

        If an input turns out to be wrong before the first state is saved, nothing stays.

        Parameters
        ----------
        content
            What was found in the data: names that a user understands, and values. A checkpoint of other data is
            refused.
        """
        self._begin(content)
        _in_use[:] = [each for each in _in_use if each.directory != self.directory]
        _in_use.append(self)
        try:
            yield
        except InputError:
            self.give_up()
            raise
        finally:
            self.save_results()

    def _begin(self, content: Mapping[str, str]) -> None:
        if not self._is_resumed:
            self._make({_MEASUREMENT: self._identity, _CONTENT: dict(content)})
            return
        _check_same(self.directory, _read_about(self.directory)[_CONTENT], content)
        if not self.has_state:
            _warn(
                f"{self.directory}: the checkpoint has no state yet, because the earlier run ended too early; the"
                " measurement begins anew"
            )

    def _make(self, about: Mapping[str, Mapping[str, str]]) -> None:
        remove_checkpoint(self.directory)
        try:
            with unfinished_directory(self.directory) as private:
                made = private / "checkpoint"
                made.mkdir(mode=0o700)
                (made / _ABOUT).write_text(json.dumps(about, indent=2), encoding="utf-8")
                made.rename(self.directory)
        except OSError as error:
            raise InputError(
                f"{self.directory}: the checkpoint cannot be written: {error.strerror or error}"
            ) from error

    def load(self, name: str) -> Any:
        """Return the state that was saved last under a name; None if there is none."""
        path = self.directory / f"{name}{_STATE}"
        return _read(path) if path.exists() else None

    def save(self, name: str, state: Any) -> None:
        """Save a state in the place of an earlier one of the same name."""
        self._write(self.directory / f"{name}{_STATE}", state)
        self._saved = time.monotonic()

    def results(self, name: str) -> "_StoredResults":
        """Return the results that were stored under a name; those that are added are stored every minute."""
        there = self._files(_RESULTS, f"{name}.*")
        found: dict[Hashable, Any] = {}
        for path in there:
            found |= _read(path)
        results = _StoredResults(self, name, found, len(there))
        self._results.append(results)
        return results

    def part(self, name: str) -> StateStore:
        """Return a store within this one, whose names are its own."""
        return _NamedPart(self, name)

    def save_results(self) -> None:
        """Store the results that were added since the last time."""
        for results in self._results:
            results.save()

    @contextmanager
    def until_written(self) -> Iterator[None]:
        """Remove the checkpoint at the end of the block, in which the results are written."""
        try:
            yield
        except InputError:
            self.give_up()
            raise
        self.remove()

    def remove(self) -> None:
        """Remove the checkpoint."""
        if self in _in_use:
            _in_use.remove(self)
        remove_checkpoint(self.directory)

    def give_up(self) -> None:
        """Leave the checkpoint to a run that resumes, or remove it if nothing has been stored in it."""
        if not self.has_state:
            self.remove()

    def write_results(self, name: str, number: int, found: Mapping[Hashable, Any]) -> None:
        """Store results under a name and a number."""
        self._write(self.directory / f"{name}.{number:06d}{_RESULTS}", dict(found))

    def _write(self, path: Path, state: Any) -> None:
        try:
            write_state(path, state)
        # The disk is full, or an object of the user's own cannot be pickled.
        except Exception as error:
            if not self._has_failed:
                reason = getattr(error, "strerror", None) or f"{type(error).__name__}: {error}"
                _warn(
                    f"{self.directory}: the state of the measurement could not be stored ({reason}); the measurement"
                    " goes on, and tries again later"
                )
            self._has_failed = True

    def _files(self, ending: str, name: str = "*") -> list[Path]:
        return sorted(self.directory.glob(f"{name}{ending}"))


class _StoredResults(Results[Any]):
    """Results of which those that were added are stored every ``EVERY`` seconds."""

    def __init__(
        self, store: CheckpointStore, name: str, found: Mapping[Hashable, Any], files: int
    ) -> None:
        super().__init__()
        self._found = dict(found)
        self._store, self._name = store, name
        self._numbers = count(files)
        self._new: dict[Hashable, Any] = {}
        self._stored = time.monotonic()

    def add(self, key: Hashable, result: Any) -> None:
        """Add a result."""
        super().add(key, result)
        self._new[key] = result
        if time.monotonic() - self._stored > EVERY:
            self.save()

    def save(self) -> None:
        """Store the results that were added since the last time."""
        # Another thread may call this at any moment, to end the process. Each result is then stored at least once.
        new = dict(self._new)
        if new:
            self._store.write_results(self._name, next(self._numbers), new)
        for key in new:
            self._new.pop(key, None)
        self._stored = time.monotonic()


@dataclass(frozen=True)
class _NamedPart(StateStore):
    """A store whose names begin with a word."""

    whole: StateStore
    name: str

    @property
    def is_due(self) -> bool:
        return self.whole.is_due

    def load(self, name: str) -> Any:
        return self.whole.load(f"{self.name}.{name}")

    def save(self, name: str, state: Any) -> None:
        self.whole.save(f"{self.name}.{name}", state)

    def results(self, name: str) -> Results[Any]:
        return self.whole.results(f"{self.name}.{name}")

    def part(self, name: str) -> Self:
        return type(self)(self, name)


def checkpoint_beside(shapes: Path) -> Path:
    """Return the name of the checkpoint of a table of shapes: NAME.checkpoint for NAME.fits, NAME.ecsv.checkpoint."""
    return companion(shapes, "checkpoint").with_suffix("")


def checkpoints_left() -> list[Path]:
    """Store the last results of the measurements of this process, which is about to end; return where states are."""
    stores, _in_use[:] = tuple(_in_use), []
    for store in stores:
        store.save_results()
    return [store.directory for store in stores if store.has_state]


def remove_checkpoint(directory: Path) -> None:
    """Remove a checkpoint if there is one."""
    if not os.path.lexists(directory):
        return
    _check_kind(directory)
    # A directory that is half removed must not be taken for a checkpoint.
    with unfinished_directory(directory) as private:
        directory.rename(private / "removed")
        shutil.rmtree(private / "removed", ignore_errors=True)


def _check_kind(directory: Path) -> None:
    """Refuse what is no checkpoint of this user."""
    if directory.is_symlink() or not (directory / _ABOUT).is_file():
        raise InputError(
            f"{directory}: this name is needed for the checkpoint, but something else has it; move it away, or give"
            " the output another name"
        )
    if directory.stat().st_uid != os.geteuid():
        raise InputError(
            f"{directory}: this checkpoint belongs to another user; give the output another name"
        )


def _read_about(directory: Path) -> dict[str, dict[str, str]]:
    """Return what a checkpoint depends on: the measurement, and the content of its data."""
    try:
        about = json.loads((directory / _ABOUT).read_text(encoding="utf-8"))
        return {name: dict(about[name]) for name in (_MEASUREMENT, _CONTENT)}
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise _damaged(directory / _ABOUT, f"{type(error).__name__}: {error}") from error


def _check_same(directory: Path, then: Mapping[str, str], now: Mapping[str, str]) -> None:
    """Refuse a checkpoint of another measurement, and name what differs."""
    for name in {**now, **then}:
        if (change := _change(name, then.get(name), now.get(name))) is not None:
            raise InputError(
                f"{directory}: this checkpoint belongs to another measurement: {change}; use the same inputs, options"
                " and version, or leave out --resume (in Python: resumes=False) to begin anew"
            )


def _change(name: str, before: str | None, after: str | None) -> str | None:
    """Say how one of the things that a state depends on has changed; None where it has not."""
    if before == after:
        return None
    if before is None:
        return f"the earlier run did not have {name}, which is {after} now"
    if after is None:
        return f"the earlier run had {name} ({before}), which this run does not have"
    return f"{name} was {before} in the earlier run and is {after} now"


def _check_states(directory: Path) -> None:
    for path in sorted(directory.iterdir()):
        if path.suffix in {_STATE, _RESULTS}:
            try:
                check_state(path)
            except (OSError, DamagedError) as error:
                raise _damaged(path, str(error)) from error


def _read(path: Path) -> Any:
    try:
        return read_state(path)
    except (OSError, DamagedError) as error:
        raise _damaged(path, str(error)) from error


def _damaged(path: Path, how: str) -> InputError:
    return InputError(
        f"{path}: this part of a checkpoint is damaged ({how}); leave out --resume (in Python: resumes=False) to begin"
        " anew"
    )


def _warn(text: str) -> None:
    warnings.warn(text, CheckpointWarning, stacklevel=3)
