"""The record of a target in a directory, from which its section of the page is written."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from uvshear.errors import InputError
from uvshear.io.records import read_record
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.paper_target import PaperTarget

WAYS = ("paper", "as_paper", "own")


@dataclass(frozen=True)
class ReproducedTarget:
    """A target that has been run.

    Parameters
    ----------
    name, title
        Name on the command line, and heading of the section.
    scale
        Scale at which it was run.
    seed
        Seed of its random numbers.
    seconds
        Processor time that its parts took, added up [s].
    quantities
        Rows of its table.
    picture
        Name of the file of its picture.
    caption
        What the picture shows.
    remarks
        Sentences on the method and the differences.
    commit
        Commit of the program that wrote the record, for the documentation; empty if it is not known.
    """

    name: str
    title: str
    scale: str
    seed: int
    seconds: float
    quantities: tuple[Quantity, ...]
    picture: str
    caption: str
    remarks: tuple[str, ...]
    commit: str = ""

    @classmethod
    def from_finding(
        cls, target: PaperTarget, scale: str, finding: Finding, seconds: float
    ) -> Self:
        """Return the record of what a target has found."""
        return cls(
            target.name,
            target.title,
            scale,
            target.seed,
            seconds,
            finding.quantities,
            f"{target.name}.png",
            finding.caption,
            finding.remarks,
        )

    def record(self) -> dict[str, Any]:
        """Return names and values for a JSON file."""
        return {
            "target": self.name,
            "title": self.title,
            "scale": self.scale,
            "seed": self.seed,
            "seconds": self.seconds,
            "quantities": [_record_of(quantity) for quantity in self.quantities],
            "picture": self.picture,
            "caption": self.caption,
            "remarks": list(self.remarks),
        }

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read the record of a target.

        Raises
        ------
        InputError
            The file is not such a record.
        """
        record: dict[str, Any] = read_record(path, "the record of a reproduced target")
        try:
            return cls(
                record["target"],
                record["title"],
                record["scale"],
                record["seed"],
                record["seconds"],
                tuple(_quantity_of(row) for row in record["quantities"]),
                record["picture"],
                record["caption"],
                tuple(record["remarks"]),
                record.get("commit", ""),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(
                f"{path}: is not the record of a reproduced target; remove it, or give another directory"
            ) from error


def _record_of(quantity: Quantity) -> dict[str, Any]:
    """Return a row; an estimate is a pair of its value and its error."""
    found: dict[str, Any] = {"quantity": quantity.name}
    for way in WAYS:
        estimate: Estimate | None = getattr(quantity, way)
        found[way] = None if estimate is None else [estimate.value, estimate.error]
    return found


def _quantity_of(row: Mapping[str, Any]) -> Quantity:
    estimates = {way: _estimate_of(row[way]) for way in WAYS}
    return Quantity(row["quantity"], **estimates)


def _estimate_of(pair: Sequence[float | None] | None) -> Estimate | None:
    if pair is None or pair[0] is None:
        return None
    return Estimate(float(pair[0]), None if pair[1] is None else float(pair[1]))
