"""One source as an estimator of the shear sees it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np

from uvshear.galaxy import EllipticityPrior, Profile
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import ShapeMeasurement
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import measure_shape
from uvshear.typing import Array, Complex

Kept: TypeAlias = Mapping[str, float | Array]
"""Statistics of one source: a number, or a one-dimensional array, for each column."""

DrawNoise: TypeAlias = Callable[[int], Complex[Array, " cell"]]
"""From a seed to noise of the facet's cells, in standard deviations of each component; independent of the data's."""


def noise_named(name: tuple[int, ...], cells: int) -> DrawNoise:
    """Return what draws the noise of a source, the same for the same seed and ``name`` whatever else is drawn."""

    def draw(seed: int) -> Complex[Array, " cell"]:
        rng = np.random.default_rng([seed, *name])
        first, second = rng.standard_normal((2, cells))
        return first + 1j * second

    return draw


@dataclass(frozen=True)
class Column:
    """A column of statistics.

    Parameters
    ----------
    description
        What it means, for the file.
    unit
        As astropy spells it; None of a number without a unit.
    """

    description: str
    unit: str | None = None


@dataclass(frozen=True)
class SourceFacet:
    """The facet of one source, everything else subtracted, and what is known of the source beforehand.

    It comes from a measurement, or is drawn: whoever has it does not know which.

    Parameters
    ----------
    facet
        Sufficient statistics of the source, fluxes in Jy at 1.4 GHz.
    cells
        The square of pixels that the facet's cells belong to.
    prior
        Prior of the source's shape.
    flux
        Flux of the catalogue [Jy].
    profile
        Brightness profile that is fitted.
    population
        Distribution of intrinsic ellipticities, for weights.
    draw_noise
        Draws more noise of the facet's kind.
    """

    facet: Facet
    cells: Cutout
    prior: ShapePrior
    flux: float
    profile: Profile
    population: EllipticityPrior
    draw_noise: DrawNoise

    @cached_property
    def shape(self) -> ShapeMeasurement:
        """The measured shape."""
        return measure_shape(self.facet, self.prior, self.profile)


@runtime_checkable
class Statistic(Protocol):
    """Numbers of a source that are worked out from its facet and kept beside its shape."""

    @property
    def columns(self) -> Mapping[str, Column]:
        """The columns that are kept, by name; none where the table of shapes has all that is needed."""
        ...

    def statistic(self, source: SourceFacet) -> Kept | None:
        """Work out the value of each column; None where the source has none."""
        ...
