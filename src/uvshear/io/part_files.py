"""Parts of a long computation, each in a file of its own: a run that is stopped goes on from those that are there."""

import json
import shutil
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from uvshear.errors import InputError
from uvshear.io.outputs import new_file, write_json
from uvshear.io.records import read_record
from uvshear.io.unfinished import unfinished_directory
from uvshear.typing import Array

_ABOUT: Final = "about.json"
_ENDING: Final = ".npz"


@dataclass(frozen=True)
class PartFiles:
    """The parts of one computation in a directory.

    Parameters
    ----------
    directory
        Directory of the parts, which is made when the first is saved.
    identity
        What the parts depend on: names that a user understands, and values.
    """

    directory: Path
    identity: Mapping[str, str]

    def check(self) -> None:
        """Refuse parts of a computation with other options, and a directory that is none of parts."""
        if not self.directory.exists():
            return
        about = self.directory / _ABOUT
        if not about.is_file():
            raise InputError(
                f"{self.directory}: this name is needed for the parts of the computation, but something else has it;"
                " move it away, or give another directory"
            )
        before = read_record(about, "the description of the parts of a computation")
        for name in {**self.identity, **before}:
            was, is_now = before.get(name), self.identity.get(name)
            if was != is_now:
                raise InputError(
                    f"{self.directory}: these parts belong to another computation: {name} was {was} and is {is_now}"
                    " now; give another directory, or --overwrite (overwrite=True) to begin anew"
                )

    def remove(self) -> None:
        """Remove all parts."""
        if (self.directory / _ABOUT).is_file():
            # A directory that is half removed must not be taken for something else.
            with unfinished_directory(self.directory) as private:
                self.directory.rename(private / "removed")
                shutil.rmtree(private / "removed", ignore_errors=True)

    def __contains__(self, name: str) -> bool:
        return self._path(name).exists()

    def save(self, name: str, values: Mapping[str, Array]) -> None:
        """Save a part, whole or not at all."""
        if not self.directory.exists():
            self._create()
        with new_file(self._path(name), overwrite=True) as temporary, temporary.open("wb") as file:
            arrays: dict[str, Any] = {key: np.asarray(value) for key, value in values.items()}
            np.savez(file, **arrays)

    def _create(self) -> None:
        """Make the directory together with its description: one without would be taken for something else."""
        try:
            self.directory.parent.mkdir(parents=True, exist_ok=True)
            with unfinished_directory(self.directory) as private:
                made = private / "made"
                made.mkdir()
                write_json(made / _ABOUT, dict(self.identity), overwrite=True)
                made.rename(self.directory)
        except OSError as error:
            raise InputError(
                f"{self.directory}: cannot be created: {error.strerror or error}"
            ) from error

    def load(self, name: str) -> dict[str, Array]:
        """Return a part."""
        path = self._path(name)
        try:
            with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
                return {key: file[key] for key in file.files}
        except (OSError, ValueError, KeyError, zipfile.BadZipFile, json.JSONDecodeError) as error:
            raise InputError(
                f"{path}: this part of the computation is damaged ({type(error).__name__}); remove it, so that it is"
                " computed anew"
            ) from error

    def _path(self, name: str) -> Path:
        return self.directory / f"{name}{_ENDING}"
