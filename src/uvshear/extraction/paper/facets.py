"""The base classes of the methods that make facets from visibilities."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from uvshear.extraction.field import Field
from uvshear.galaxy import Galaxies, Profile
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Visibilities
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float

INFORMATIVE = 2.5
"""Baselines longer than this over the median scale length are left out: |V|^2 is 7e-8 there for the median galaxy, and
4e-6 for a galaxy half as large."""


@dataclass(frozen=True)
class Target:
    """A source whose facet is made: its position, its expected size, and the longest baseline.

    Parameters
    ----------
    galaxy
        The source as the catalogue has it (one element); the facet is centred on it.
    scale_length
        Median of the prior on the scale length [rad].
    uv_range
        Its maximum is finite: the longest baseline that is used.
    frequency
        Highest frequency, at which the longest baseline has that length [Hz].
    half_width
        Distance from its centre within which the galaxy exceeds the noise [rad]; 0 before it is fitted.
    """

    galaxy: Galaxies
    scale_length: float
    uv_range: UvRange
    frequency: float
    half_width: float = 0.0

    @classmethod
    def from_field(cls, field: Field, source: int, fit: GalaxyFit | None = None) -> Self:
        """Describe a source of a field; ``fit`` is its latest fit, if there is one."""
        return cls(
            galaxy=field.sky.select(np.array([source])),
            scale_length=float(np.exp(field.size.log_median[source])),
            uv_range=field.uv_range,
            frequency=field.summary.frequency,
            half_width=fit.half_width if fit else 0.0,
        )

    @property
    def informative_uv_max(self) -> float:
        """Longest baseline that carries information on the source [wavelengths]."""
        return min(self.uv_range.maximum, INFORMATIVE / self.scale_length)


class FacetBuilder(ABC):
    """A facet that is being gathered: visibilities are added chunk by chunk, in any order, from any file."""

    @abstractmethod
    def add(self, residual: Visibilities, model: Galaxies) -> None:
        """Add a chunk from which all models were subtracted, including that of the source (``model``)."""

    @abstractmethod
    def merge(self, later: Self) -> None:
        """Add what another builder of the same facet has gathered."""

    @abstractmethod
    def facet(self, model: Galaxies) -> Facet:
        """Add the source's own ``model`` back, and return the facet."""


class FacetMethod(ABC):
    """A method of making facets."""

    averages_cells: ClassVar[bool] = False
    """Whether visibilities are averaged in cells, which makes galaxies rounder."""

    @abstractmethod
    def open(
        self,
        target: Target,
        profile: Profile,
        power: Float[Array, " cell"] | None = None,
    ) -> FacetBuilder:
        """Begin the facet of one source; its ``power``, if it is already known, is not gathered again."""


def spectral_gain(galaxy: Galaxies, frequency: Float[Array, " chan"]) -> Float[Array, " chan"]:
    """Flux density at each frequency over that at the reference frequency, of one source."""
    return (frequency / galaxy.reference_frequency) ** float(galaxy.spectral_index[0])
