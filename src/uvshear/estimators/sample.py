"""What estimators of the shear are given: columns of numbers, one row a source."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.typing import Array, Bool, Complex, Float, Int


@dataclass(frozen=True)
class Sample:
    """Sources with what was measured or kept of them.

    Parameters
    ----------
    columns
        Arrays of one length by name, in SI and radians; NaN (or an empty array) where a source has no value. Names are
        those of the table of shapes and of the estimators' statistics.
    local_north
        Angle of local North at each source, from the m axis towards +l [rad] (``geometry.directions.local_north``):
        it turns what is in the frame of (l, m) to the frame of the sky.
    """

    columns: Mapping[str, Array]
    local_north: Float[Array, " source"]

    def __len__(self) -> int:
        return len(self.local_north)

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]

    def select(self, chosen: Bool[Array, " source"] | Int[Array, " chosen"] | slice) -> Self:
        """Return some of the sources (any one-dimensional numpy index)."""
        columns = {name: values[chosen] for name, values in self.columns.items()}
        return type(self)(columns, self.local_north[chosen])

    @classmethod
    def from_rows(cls, rows: Sequence[Mapping[str, float | Array]]) -> Self:
        """Put rows of the same columns together; the sources are at the phase centre."""
        columns = {name: _column([row[name] for row in rows]) for name in (rows[0] if rows else ())}
        return cls(columns, np.zeros(len(rows)))


def _column(values: Sequence[float | Array]) -> Array:
    if not any(isinstance(value, np.ndarray) for value in values):
        return np.array(values, float)
    column = np.empty(len(values), object)
    column[:] = values
    return column


def ellipticity_of(sample: Sample) -> Complex[Array, " source"]:
    """Return the measured ellipticities of a sample that has the columns ``e1`` and ``e2``."""
    e: Complex[Array, " source"] = sample["e1"] + 1j * sample["e2"]
    return e
