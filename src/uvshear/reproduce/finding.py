"""What a target has found: numbers beside those of the paper, a picture, and remarks on the differences."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from matplotlib.figure import Figure

from uvshear.diagnostics.slope import Slope

Curves: TypeAlias = Mapping[str, Sequence[float] | Sequence[Sequence[float]]]
"""Numbers behind a picture, by name."""


@dataclass(frozen=True)
class Estimate:
    """A number and its standard error, which is None where it is unknown or negligible."""

    value: float
    error: float | None = None

    @classmethod
    def from_slope(cls, slope: Slope) -> "Estimate":
        """Return a slope with the error that follows from the scatter of the galaxies."""
        return cls(slope.value, slope.error)

    @classmethod
    def modulus(cls, first: "Estimate", second: "Estimate") -> "Estimate":
        """Return the modulus of a number with these real and imaginary parts."""
        value = math.hypot(first.value, second.value)
        parts = ((each.value, each.error or 0.0) for each in (first, second))
        error = math.hypot(*(value * error for value, error in parts)) / max(value, 1e-300)
        return cls(value, error)


def signed(value: float, decimals: int = 4) -> str:
    """Return a number with its sign, as it is written in a text."""
    return f"{value:+.{decimals}f}".replace("-", "−")


@dataclass(frozen=True)
class Quantity:
    """A quantity as the paper has it and as it is found here.

    Parameters
    ----------
    name
        Name for the reader, with its unit.
    paper
        Number that is printed in the paper; None where there is none.
    as_paper
        Number that is found in the way of the paper; None where this is not possible.
    own
        Number that is found with the exact facets and the converged extraction of this package, or None.
    """

    name: str
    paper: Estimate | None = None
    as_paper: Estimate | None = None
    own: Estimate | None = None

    @property
    def pull(self) -> float | None:
        """Difference between the number that is found in the way of the paper and the paper's, over its error."""
        if self.paper is None or self.as_paper is None:
            return None
        error = math.hypot(self.paper.error or 0.0, self.as_paper.error or 0.0)
        return (self.as_paper.value - self.paper.value) / error if error > 0 else None


@dataclass(frozen=True)
class Finding:
    """Result of a target.

    Parameters
    ----------
    quantities
        Numbers, one row of the table each.
    picture
        Picture to be laid beside that of the paper.
    caption
        What the picture shows.
    remarks
        Sentences on the method and on the differences, with the numbers of the experiments that support them.
    curves
        Numbers that the picture shows.
    """

    quantities: tuple[Quantity, ...]
    picture: Figure
    caption: str
    remarks: tuple[str, ...] = ()
    curves: Curves = field(default_factory=dict)
