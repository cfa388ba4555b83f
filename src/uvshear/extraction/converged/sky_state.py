"""The sky between two major cycles: the sources as they are fitted, and the facets that they are fitted to."""

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
from uvshear.extraction.converged.sources import ModelledSource
from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import NormalEquations
from uvshear.shapes.template import Template
from uvshear.typing import Array, Complex, Float

Fits = tuple[GalaxyFit, ...]
"""Fit of each modelled source, fluxes in the unit of the facets."""


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


@dataclass(frozen=True)
class SkyState:
    """The sky at one moment after a major cycle.

    Parameters
    ----------
    sources
        The modelled sources with their priors.
    fits
        The sources as they are fitted now.
    subtracted
        The sources as the major cycle has subtracted them.
    facets
        Residual facets of the major cycle, with the part of each source's own model put back that the image of changes
        does not hold.
    image
        Image of what has changed since the major cycle.
    interaction
        The beam through which sources see one another's changes.
    neighbourhood
        Positions of the sources, and the groups that overlap.
    linearisation
        The log posterior about the sky of the last joint step; None before there was one.
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

        def put_back(k: int) -> Complex[Array, " cell"]:
            cutout = cycle.plan.cutouts[k]
            left = cycle.beams.power(k, cutout) - interaction.own_power(k)
            return cycle.residuals[k] + left * sources[k].model(subtracted[k], cutout.uv)

        scale_length = np.array(
            [
                max(source.expected.scale_length, fit.scale_length)
                for source, fit in zip(sources, subtracted, strict=True)
            ]
        )
        flux = np.array([source.expected.flux for source in sources])
        return cls(
            sources=tuple(sources),
            fits=tuple(subtracted),
            subtracted=tuple(subtracted),
            facets=tuple(executor.map(put_back, range(len(sources)))),
            image=ChangeImage(interaction),
            interaction=interaction,
            neighbourhood=Neighbourhood.from_sizes(cycle.plan.centres, flux, scale_length),
            linearisation=linearisation,
        )

    @property
    def profile(self) -> Profile:
        """Brightness profile of the sources."""
        return self.sources[0].profile

    def facet(self, source: int) -> Facet:
        """Return the facet of a source, with everything else subtracted as it is now."""
        own = self.interaction.own_power(source)
        return self._facet(source, own)

    def residual(self, source: int) -> Facet:
        """Return the facet of a source, with everything subtracted as it is now, the source too."""
        cutout = self.interaction.plan.cutouts[source]
        own = self.interaction.own_power(source)
        return self._facet(source, own - self.interaction.beams.power(source, cutout))

    def _facet(self, source: int, own: Float[Array, " cell"]) -> Facet:
        """Facet with all changes subtracted, and ``own`` times the source's present model put back."""
        cutout = self.interaction.plan.cutouts[source]
        power = self.interaction.beams.power(source, cutout)
        correlation = np.zeros(len(power), np.complex64)
        self.image.subtract_from(correlation, source)
        correlation *= cutout.recentring(tuple(self.interaction.plan.offset[source]))
        correlation += self.facets[source]
        # The image of changes has taken the source's own change away, too.
        correlation += own * self.sources[source].model(self.fits[source], cutout.uv)
        return Facet(cutout.uv, correlation, power)

    def placed(self, source: int, fit: GalaxyFit) -> PlacedSource:
        """Return a source as the interaction sees it."""
        offset = self.interaction.plan.offset[source] + fit.offset
        return PlacedSource(fit.flux, tuple(offset), fit.ellipticity, fit.scale_length)

    def change_since(self, before: Sequence[GalaxyFit]) -> Float[Array, " source"]:
        """Return the change of each source since it was as ``before``, in units of the noise.

        The sources of a group have that of the sum of their models.
        """
        change = np.zeros(len(self.sources))
        for unit in self.neighbourhood.units:
            change[unit] = self.change_of_unit(unit, before)
        return change

    def change_of_unit(
        self, unit: list[int], before: Mapping[int, GalaxyFit] | Sequence[GalaxyFit]
    ) -> float:
        """Return the change of the sum of a unit's models: sources that overlap may trade what the data cannot tell."""
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
