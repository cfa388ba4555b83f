"""A mutated input: what was done to it, and the command lines that read it."""

import shutil
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Reading:
    """A command line that reads an input, and the file with its result; None where only its words are a result."""

    words: tuple[str, ...]
    result: Path | None = None


@dataclass(frozen=True)
class Case:
    """An input with the commands that read it.

    Parameters
    ----------
    variant
        Clean input from which it was made.
    description
        What was done to it, in one line.
    readings
        Commands that read it.
    is_valid
        Tells whether it is another valid input, of which nobody can tell that it was mutated. It is asked only if a
        result has changed without a word.
    """

    variant: str
    description: str
    readings: tuple[Reading, ...]
    is_valid: Callable[[], bool]


class Kind(ABC):
    """A kind of input: where a clean one is, how it is mutated, and what reads it."""

    variants: tuple[str, ...]
    """Names of clean inputs."""

    def clean(self, clean: Path, variant: str, directory: Path) -> Case:
        """Return the case in which nothing is mutated."""
        path = self.copied(clean, variant, directory)
        readings = self.readings(clean, variant, path)
        return Case(variant, "not mutated", readings, lambda: False)

    def mutated(self, clean: Path, directory: Path, rng: np.random.Generator) -> Case:
        """Draw a case."""
        variant = self.variants[rng.integers(len(self.variants))]
        path = self.copied(clean, variant, directory)
        description = self.mutate(clean, variant, path, rng)
        readings = self.readings(clean, variant, path)
        return Case(
            variant,
            f"{variant}: {' '.join(description.split())}",
            readings,
            lambda: self.is_valid(clean, variant, path),
        )

    def copied(self, clean: Path, variant: str, directory: Path) -> Path:
        """Copy the clean input of this name, a file or a directory, into a directory."""
        source, target = clean / variant, directory / variant
        if source.is_dir():
            shutil.copytree(source, target)
        else:
            shutil.copy(source, target)
        return target

    @abstractmethod
    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Change the copy, and return in words how."""

    @abstractmethod
    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Return the commands that read the input."""

    @abstractmethod
    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Tell whether the mutated input is another valid one."""
