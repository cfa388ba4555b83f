"""A situation: what is done to clean files, and what a measurement must make of it."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from astropy.table import Table

MEASURED = ("e1", "e2", "e1_err", "e2_err", "snr", "flux_fit")


@dataclass(frozen=True)
class Files:
    """Copies of the clean files, in a directory of their own.

    Parameters
    ----------
    directory
        Directory, in which the situation may do what it likes.
    """

    directory: Path

    @property
    def field(self) -> Path:
        """Measurement Set of three galaxies."""
        return self.directory / "field.ms"

    @property
    def catalogue(self) -> Path:
        """Catalogue of the galaxies, in ECSV, with ra, dec, flux and id."""
        return self.directory / "cat.ecsv"


@dataclass(frozen=True)
class Expected:
    """What is expected of a command.

    Parameters
    ----------
    refusal
        Pattern of the one line with which it is refused; None if the shapes are the clean ones.
    note
        Pattern of a note that goes with the shapes; without it there is none.
    within
        Largest difference of shapes, in units of their errors.
    measures
        Whether the command writes shapes.
    """

    refusal: str | None = None
    note: str | None = None
    within: float = 1e-6
    measures: bool = True

    def check(self, status: int, told: str, shapes: Path, clean: Table) -> None:
        """Compare the status, what was said and the shapes with what is expected."""
        if self.refusal is not None:
            assert status == 2, told
            assert len(told.splitlines()) == 1, told
            assert re.search(self.refusal, told), told
            assert not shapes.exists()
            return
        assert status == 0, told
        if self.note is None:
            assert told == "", told
        else:
            assert re.search(self.note, told), told
        if not self.measures:
            return
        measured = Table.read(shapes)
        assert list(measured["flag"].astype(str)) == list(clean["flag"].astype(str))
        for name in MEASURED:
            error = clean["flux_fit_err"] if name == "flux_fit" else clean["e1_err"]
            scale = error if name != "snr" else np.ones(len(clean))
            difference = np.abs(measured[name] - clean[name]) / scale
            assert np.max(difference) <= self.within, f"{name}: {np.max(difference)}"


SAME = Expected()


def refused(pattern: str) -> Expected:
    """Refused with one line."""
    return Expected(refusal=pattern)


def noted(pattern: str, within: float = 1e-6) -> Expected:
    """The clean shapes, and a note; within some part of their errors, where rows are lost."""
    return Expected(note=pattern, within=within)


@dataclass(frozen=True)
class Situation:
    """A situation.

    Parameters
    ----------
    name
        Short description.
    make
        Function that changes the files, and returns further words of the command, if any.
    expected
        What is expected of ``measure``.
    words
        Words of the command before those that ``make`` returns, ``{}`` being the directory.
    informs
        Whether ``info`` must say of the set what ``measure`` says.
    """

    name: str
    make: Callable[[Files], object]
    expected: Expected = SAME
    words: str = "measure {}/field.ms --catalogue {}/cat.ecsv -o {}/out.fits"
    informs: bool = False
