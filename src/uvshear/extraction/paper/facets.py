"""The protocol of the ways in which visibilities around a source become a facet."""

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
"""Baselines beyond this over the median scale length are left out: |V|^2 is 7e-8 there for the median galaxy,
4e-6 for one half as large."""


@dataclass(frozen=True)
class Target:
    """A source to be cut out: its place, its size as expected, and the longest baseline there is.

    Parameters
    ----------
    galaxy
        The source as the catalogue has it (one element); the facet is centred on it.
    scale_length
        Median of the prior on the scale length [rad].
    uv_range
        Its maximum is finite: the longest baseline that is used.
    frequency
        Highest frequency, at which that baseline is so long [Hz].
    half_width
        Distance from its centre up to which the galaxy is known to matter [rad]; 0 before it was fitted.
    """

    galaxy: Galaxies
    scale_length: float
    uv_range: UvRange
    frequency: float
    half_width: float = 0.0

    @classmethod
    def from_field(cls, field: Field, source: int, fit: GalaxyFit | None = None) -> Self:
        """Describe a source of a field; ``fit`` is what is known of it."""
        return cls(
            galaxy=field.sky.select(np.array([source])),
            scale_length=float(np.exp(field.size.log_median[source])),
            uv_range=field.uv_range,
            frequency=field.summary.frequency,
            half_width=fit.half_width if fit else 0.0,
        )

    @property
    def informative_uv_max(self) -> float:
        """Longest baseline that tells anything of the source [wavelengths]."""
        return min(self.uv_range.maximum, INFORMATIVE / self.scale_length)


class FacetBuilder(ABC):
    """A facet being gathered: visibilities go in chunk by chunk, in any order, from any file."""

    @abstractmethod
    def add(self, residual: Visibilities, model: Galaxies) -> None:
        """Take in a chunk from which all models were subtracted, that of the source (``model``) too."""

    @abstractmethod
    def merge(self, later: Self) -> None:
        """Add what another builder of the same facet has gathered."""

    @abstractmethod
    def facet(self, model: Galaxies) -> Facet:
        """Put the source's own ``model`` back, and return the facet."""


class FacetMethod(ABC):
    """A way of making facets."""

    averages_cells: ClassVar[bool] = False
    """Whether visibilities are averaged in cells, which makes galaxies rounder."""

    @abstractmethod
    def open(
        self,
        target: Target,
        profile: Profile,
        power: Float[Array, " cell"] | None = None,
    ) -> FacetBuilder:
        """Begin the facet of one source; its ``power``, where known from before, is not gathered again."""


def spectral_gain(galaxy: Galaxies, frequency: Float[Array, " chan"]) -> Float[Array, " chan"]:
    """Flux density at each frequency over that at the reference frequency, of one source."""
    return (frequency / galaxy.reference_frequency) ** float(galaxy.spectral_index[0])
