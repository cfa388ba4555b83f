"""The sky between two major cycles: the fitted sources, and the facets to which they are fitted."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.execution import Executor
from uvshear.extraction.converged.change_image import ChangeImage
from uvshear.extraction.converged.couplings import Couplings
from uvshear.extraction.converged.interaction import Interaction, PlacedSource
from uvshear.extraction.converged.major_cycle import Facets, MajorCycle
from uvshear.extraction.converged.neighbourhood import Neighbourhood
from uvshear.extraction.converged.own_models import with_own_models
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.extraction.converged.sources import ModelledSource
from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import NormalEquations
from uvshear.shapes.template import Template
from uvshear.typing import Array, Float

Fits = tuple[GalaxyFit, ...]
"""Fit of each modelled source, with its flux in the unit of the facets."""


@dataclass(frozen=True)
class Linearisation:
    """The log posterior of all sources to second order, about the sky of the last joint step.

    Parameters
    ----------
    equations
        Gradient and own block of each source.
    couplings
        Blocks between sources.
    """

    equations: tuple[NormalEquations, ...]
    couplings: Couplings


def neighbourhood_of(
    plan: MajorCyclePlan, sources: Sequence[ModelledSource], subtracted: Sequence[GalaxyFit]
) -> Neighbourhood:
    """Return the positions and groups of the sources that a major cycle has subtracted."""
    scale_length = np.array(
        [
            max(source.expected.scale_length, fit.scale_length)
            for source, fit in zip(sources, subtracted, strict=True)
        ]
    )
    flux = np.array([source.expected.flux for source in sources])
    return Neighbourhood.from_sizes(plan.centres, flux, scale_length)


@dataclass(frozen=True)
class SkyState:
    """The sky at one moment after a major cycle.

    Parameters
    ----------
    sources
        The modelled sources with their priors.
    fits
        The present fits of the sources.
    subtracted
        The fits that the major cycle has subtracted.
    facets
        Residual facets of the major cycle, to which the part of each source's own model that the image of changes does
        not hold has been added back.
    image
        Image of the changes since the major cycle.
    interaction
        The beam that propagates the change of one source to another.
    neighbourhood
        Positions of the sources, and the groups that overlap.
    linearisation
        The log posterior about the sky of the last joint step; None before the first step.
    """

    sources: tuple[ModelledSource, ...]
    fits: Fits
    subtracted: Fits
    facets: Facets
    image: ChangeImage
    interaction: Interaction
    neighbourhood: Neighbourhood
    linearisation: Linearisation | None = None

    @classmethod
    def from_major_cycle(
        cls,
        cycle: MajorCycle,
        sources: Sequence[ModelledSource],
        subtracted: Sequence[GalaxyFit],
        executor: Executor,
        linearisation: Linearisation | None = None,
    ) -> Self:
        """Begin with the sky that a major cycle has subtracted, and with a linearisation where one is known."""
        interaction = Interaction(cycle.plan, cycle.beams, sources[0].profile)
        return cls(
            sources=tuple(sources),
            fits=tuple(subtracted),
            subtracted=tuple(subtracted),
            facets=with_own_models(cycle, interaction, sources, subtracted, executor),
            image=ChangeImage(interaction),
            interaction=interaction,
            neighbourhood=neighbourhood_of(cycle.plan, sources, subtracted),
            linearisation=linearisation,
        )

    @property
    def profile(self) -> Profile:
        """Brightness profile of the sources."""
        return self.sources[0].profile

    def facet(self, source: int) -> Facet:
        """Return the facet of a source, with the present models of all other sources subtracted."""
        own = self.interaction.own_power(source)
        return self._facet(source, own)

    def residual(self, source: int) -> Facet:
        """Return the facet of a source, with the present models of all sources subtracted, including its own."""
        cutout = self.interaction.plan.cutouts[source]
        own = self.interaction.own_power(source)
        return self._facet(source, own - self.interaction.beams.power(source, cutout))

    def _facet(self, source: int, own: Float[Array, " cell"]) -> Facet:
        """Facet with all changes subtracted, and ``own`` times the source's present model added back."""
        cutout = self.interaction.plan.cutouts[source]
        power = self.interaction.beams.power(source, cutout)
        correlation = np.zeros(len(power), np.complex64)
        self.image.subtract_from(correlation, source)
        cutout.recentre(correlation, tuple(self.interaction.plan.offset[source]))
        correlation += self.facets[source]
        # The image of changes has taken the source's own change away, too.
        correlation += own * self.sources[source].model(self.fits[source], cutout.uv)
        return Facet(cutout.uv, correlation, power)

    def placed(self, source: int, fit: GalaxyFit) -> PlacedSource:
        """Return the parameters of a source for the interaction."""
        offset = self.interaction.plan.offset[source] + fit.offset
        return PlacedSource(fit.flux, tuple(offset), fit.ellipticity, fit.scale_length)

    def change_of_unit(
        self, unit: list[int], before: Mapping[int, GalaxyFit] | Sequence[GalaxyFit]
    ) -> float:
        """Return the change of the sum of a unit's models: the data may not tell how overlapping sources share it."""
        if len(unit) == 1:
            return self._change_of_source(unit[0], before[unit[0]])
        place, plane = self.neighbourhood.place, self.interaction.plane_around(unit[0])
        change = np.zeros(len(plane.power), np.complex64)
        for source in unit:
            apart = tuple(place[source] - place[unit[0]])
            template = Template(plane.uv, self.sources[source].profile, apart)
            change += template.model(self.fits[source]) - template.model(before[source])
        return math.sqrt(max(float(np.sum(plane.power * np.abs(change) ** 2)), 0.0))

    def _change_of_source(self, source: int, before: GalaxyFit) -> float:
        if before is (now := self.fits[source]):
            return 0.0
        cutout, model = self.interaction.plan.cutouts[source], self.sources[source].model
        power = self.interaction.beams.power(source, cutout)
        change = model(now, cutout.uv) - model(before, cutout.uv)
        return float(np.sqrt(max(float(np.sum(power * np.abs(change) ** 2)), 0.0)))
