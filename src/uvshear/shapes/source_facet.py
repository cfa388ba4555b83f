"""The facet of one source as it is passed to estimators of the shear, and the statistics that they keep."""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np

from uvshear.galaxy import EllipticityPrior, Profile
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import ShapeMeasurement
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.significance import with_significance
from uvshear.shapes.statistic_flag import StatisticFlag
from uvshear.typing import Array, Complex, Float

Kept: TypeAlias = Mapping[str, float | Array | str]
"""Statistics of one source: a number, a one-dimensional array or a word for each column."""

DrawNoise: TypeAlias = Callable[[int], Complex[Array, " cell"]]
"""Function from a seed to noise on the cells of a facet, in standard deviations of each component; it is independent of
the noise of the data."""


def noise_named(name: tuple[int, ...], cells: int) -> DrawNoise:
    """Return a function that draws the noise of one source.

    Parameters
    ----------
    name
        Numbers that identify the source: the same seed and name give the same noise, whatever else is drawn.
    cells
        Number of cells of the facet.
    """

    def draw(seed: int) -> Complex[Array, " cell"]:
        rng = np.random.default_rng([seed, *name])
        first, second = rng.standard_normal((2, cells))
        return first + 1j * second

    return draw


@dataclass(frozen=True)
class Column:
    """Meaning of a column of statistics.

    Parameters
    ----------
    description
        Description of the column for the header of a file.
    unit
        Unit as astropy spells it; None for a number without a unit.
    """

    description: str
    unit: str | None = None


@dataclass(frozen=True)
class SourceFacet:
    """The facet of one source, from which everything else is subtracted, and the prior knowledge of the source.

    A facet comes from a measurement or from a simulation; an estimator cannot tell which.

    Parameters
    ----------
    facet
        Sufficient statistics of the source, with fluxes at 1.4 GHz [Jy].
    cells
        Square of pixels whose Fourier transform gives the facet's cells.
    prior
        Prior on the source's shape.
    flux
        Flux density in the catalogue [Jy].
    profile
        Brightness profile that is fitted.
    population
        Distribution of intrinsic ellipticities, on which weights depend.
    draw_noise
        Function that draws more noise like that of the facet.
    unit
        Unit of the facet's flux, over the unit in which all sources with the same beam have the same power.
    beam
        Power of the facet in that other unit, bit for bit the same for all sources with the same beam; the power of the
        facet itself unless given.
    tests_significance
        Whether a source that the data do not show, or do not tell from a point, has a flag, as in a table of shapes.
    """

    facet: Facet
    cells: Cutout
    prior: ShapePrior
    flux: float
    profile: Profile
    population: EllipticityPrior
    draw_noise: DrawNoise
    unit: float = 1.0
    beam: Float[Array, " cell"] | None = None
    tests_significance: bool = True

    @property
    def common(self) -> Facet:
        """The facet in the unit of flux in which all sources with the same beam have the same power."""
        if self.beam is None:
            return self.facet
        return Facet(self.facet.uv, self.facet.correlation / self.unit, self.beam)

    def beam_key(self, longest: float) -> Hashable:
        """Key that is equal for sources with the same cells and the same beam up to a longest baseline [wavelengths].

        What depends on the cells and the beam alone is worked out once for all of these sources, from any of them: it
        is the same to the last bit.
        """
        power = self.common.within(longest).power
        cells = self.cells
        digest = blake2b(np.ascontiguousarray(power).tobytes(), digest_size=16).digest()
        return cells.size, cells.pixel, cells.shortest, min(cells.longest, longest), digest

    @cached_property
    def shape(self) -> ShapeMeasurement:
        """Shape measured on the facet."""
        shape = measure_shape(self.facet, self.prior, self.profile)
        if not self.tests_significance:
            return shape
        return with_significance(shape, self.facet, self.prior, self.profile)


@runtime_checkable
class Statistic(Protocol):
    """Numbers that are computed from the facet of a source and kept beside its shape."""

    @property
    def columns(self) -> Mapping[str, Column]:
        """Columns by name; none where the table of shapes already has all that is needed."""
        ...

    def statistic(self, source: SourceFacet) -> Kept | StatisticFlag | None:
        """Compute the value of each column; where the source has none, return the reason, or None."""
        ...
