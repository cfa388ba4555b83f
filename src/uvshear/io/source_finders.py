"""Catalogues as source finders write them, read through the columns that this package knows.

A source finder fits Gaussians to an image. The deconvolved width of a Gaussian (``geometry.deconvolution``) gives the
scale length of a disc with the same half-light radius, which is FWHM/2 of a Gaussian and 1.678 scale lengths of an
exponential disc. A source that the finder does not resolve is a galaxy whose size is below a limit.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from astropy import units
from astropy.table import Table

from uvshear.galaxy.size import UNKNOWN_SIGMA
from uvshear.geometry.deconvolution import Widths
from uvshear.io.columns import Columns, NamedColumn
from uvshear.typing import Array, Bool, Float

FWHM_OF_SCALE_LENGTH = 2 * 1.6783469900166605
"""Full width at half maximum of a Gaussian over the scale length of a disc of the same half-light radius."""

BELOW_LIMIT = 0.5
"""Scale length that is assumed for a source that is not resolved, as a fraction of the upper limit; ``UNKNOWN_SIGMA``
has the measurement."""

LARGEST_ANGLE = 10.0
"""Axes and position angles beyond this are no fits [rad]."""


class Sizes(NamedTuple):
    """Scale lengths from a source finder [rad], NaN where they are not known, and their standard errors.

    Parameters
    ----------
    scale_length
        Scale length of each source.
    err
        Standard error of the scale length, 0 where it is not known.
    """

    scale_length: Float[Array, " source"]
    err: Float[Array, " source"]

    @classmethod
    def from_widths(cls, widths: Widths) -> Self:
        """Return the sizes of discs; a source that is not resolved has half the limit, with a wide error."""
        alpha = widths.width / FWHM_OF_SCALE_LENGTH
        below = BELOW_LIMIT * alpha
        # This relative error makes the standard deviation of the logarithm UNKNOWN_SIGMA.
        wide = math.sqrt(math.expm1(UNKNOWN_SIGMA**2))
        return cls(
            np.where(widths.is_resolved, alpha, below),
            np.where(widths.is_resolved, widths.err / FWHM_OF_SCALE_LENGTH, wide * below),
        )

    def where(self, known: Bool[Array, " source"]) -> Self:
        """Return the sizes that are known, and NaN for the others."""
        return type(self)(
            np.where(known, self.scale_length, np.nan), np.where(known, self.err, 0.0)
        )


def fitted_values(
    columns: Columns, names: Sequence[str], assumed: Mapping[str, units.UnitBase]
) -> list[Float[Array, " source"]]:
    """Return columns of a fitted ellipse [rad], NaN where there is no value or one that no source has.

    Parameters
    ----------
    columns
        The table.
    names
        Names of the columns; those that the table lacks are zero.
    assumed
        Unit of each column where the table gives none.
    """
    found = []
    for name in names:
        values = np.zeros(len(columns.identifier))
        if columns.has(name):
            values = columns.known(name, units.rad, assumed=assumed[name])
        found.append(np.where(np.abs(values) < LARGEST_ANGLE, values, np.nan))
    return found


@dataclass(frozen=True)
class SourceFinder(ABC):
    """A source finder: how its tables are recognised, and what its columns mean.

    Parameters
    ----------
    name
        Name of the program.
    signature
        Columns by which its tables are recognised.
    """

    name: str
    signature: frozenset[str]

    def wrote(self, columns: Collection[str]) -> bool:
        """Tell whether a table with these columns is one of this finder's."""
        return self.signature <= set(columns)

    @abstractmethod
    def sources(self, table: Table) -> dict[str, NamedColumn]:
        """Return its columns by the names of this package."""

    @abstractmethod
    def sizes(self, columns: Columns) -> Sizes | None:
        """Return the sizes of its sources; None if it gives none."""

    def metadata(self, table: Table) -> Mapping[str, Any]:
        """Return facts on the catalogue that its metadata do not state as others do, by lower-case key."""
        return {}
