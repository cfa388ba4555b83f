"""The numbers that are printed in Rivi & Miller 2018, in one file for each target."""

import json
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from uvshear.reproduce.finding import Estimate


@dataclass(frozen=True)
class PublishedFigures:
    """Numbers of a part of the paper.

    Parameters
    ----------
    where
        Section, table or figure in which they are printed.
    claim
        What the paper says there, in words.
    values
        Numbers by name: a number, a pair of a number and its error, or a list of these.
    """

    where: str
    claim: str
    values: dict[str, Any]

    @classmethod
    def read(cls, target: str) -> "PublishedFigures":
        """Read the numbers of a target."""
        path = files("uvshear.reproduce") / "published" / f"{target}.json"
        return cls(**json.loads(path.read_text(encoding="utf-8")))

    def estimate(self, name: str) -> Estimate:
        """Return a number with its error, if one is printed."""
        return estimate_of(self.values[name])

    def estimates(self, name: str) -> list[Estimate]:
        """Return a list of numbers with their errors."""
        return [estimate_of(value) for value in self.values[name]]


def estimate_of(value: float | list[float]) -> Estimate:
    """Return a number of a file, or a pair of a number and its error, as an estimate."""
    if isinstance(value, list):
        return Estimate(float(value[0]), float(value[1]))
    return Estimate(float(value))
