"""The sources from which a shear is estimated: columns of numbers, one row for each source."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self, TypeAlias

import numpy as np

from uvshear.typing import Array, Bool, Complex, Float, Int

Row: TypeAlias = dict[str, object]
"""Numbers of one source by column: a float, or an object that stands for several numbers."""


@dataclass(frozen=True)
class Sample:
    """Sources with their measured numbers and statistics.

    Parameters
    ----------
    columns
        Arrays of one length by name, in SI and radians; NaN (or an empty array) where a source has no value. The names
        are those of the table of shapes and of the estimators' statistics.
    local_north
        Angle of local North at each source, from the m axis towards +l [rad] (``geometry.directions.local_north``). It
        rotates terms from the frame of (l, m) to that of the sky.
    patch
        Number of the patch of the sky of each source, by which the jackknife leaves sources out; None leaves them out
        one by one.
    """

    columns: Mapping[str, Array]
    local_north: Float[Array, " source"]
    patch: Int[Array, " source"] | None = None

    def __len__(self) -> int:
        return len(self.local_north)

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]

    def select(self, chosen: Bool[Array, " source"] | Int[Array, " chosen"] | slice) -> Self:
        """Return the sources at an index, which is any one-dimensional index of numpy."""
        columns = {name: values[chosen] for name, values in self.columns.items()}
        patch = None if self.patch is None else self.patch[chosen]
        return type(self)(columns, self.local_north[chosen], patch)

    @classmethod
    def from_rows(cls, rows: Sequence[Mapping[str, object]]) -> Self:
        """Return a sample of sources at the phase centre from rows with the same columns."""
        columns = {name: _column([row[name] for row in rows]) for name in (rows[0] if rows else ())}
        return cls(columns, np.zeros(len(rows)))


def _column(values: Sequence[object]) -> Array:
    if all(isinstance(value, int | float | np.number) for value in values):
        return np.array(values, float)
    column = np.empty(len(values), object)
    for row, value in enumerate(values):
        column[row] = value
    return column


def ellipticity_of(sample: Sample) -> Complex[Array, " source"]:
    """Return the measured ellipticities of a sample that has the columns ``e1`` and ``e2``."""
    e: Complex[Array, " source"] = sample["e1"] + 1j * sample["e2"]
    return e
