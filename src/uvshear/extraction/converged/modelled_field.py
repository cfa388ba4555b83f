"""The modelled sources of a field: their priors, and the unit of their fluxes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.constants import REFERENCE_FREQUENCY
from uvshear.extraction.converged.sources import GalaxySource, ModelledSource, PointSource
from uvshear.extraction.field import Field
from uvshear.extraction.model import Model
from uvshear.extraction.sky import with_fitted
from uvshear.galaxy import Galaxies
from uvshear.predict.response import Response
from uvshear.shapes.measurement import FitFlag, GalaxyFit
from uvshear.typing import Array, Bool, Float

ASTROMETRY = 0.3
"""Standard deviation of the catalogue's positions over the median scale length, for the sky model, unless it is known.
It is loose for a source that can be measured, but tight enough to keep neighbours from exchanging their places."""

PHOTOMETRY = 0.3
"""Relative standard deviation of the catalogue's fluxes, for the sky model, unless it is known: two galaxies one beam
apart can hardly be separated by anything else."""

SUREST_PHOTOMETRY = 0.05
"""Smallest credible relative standard deviation of a flux in the catalogue."""

LEAST_SIGMA = 1e-30
"""Smallest standard deviation of a flux [Jy] and of a position [rad]; the square of the inverse of one of 1e-155 is no
number."""


@dataclass(frozen=True)
class ModelledField:
    """The modelled sources of a field; their fits have fluxes in the unit of their facets.

    A facet has the response that all sources share, so that its flux is that of the catalogue times the ``strength`` of
    the source's own response.

    Parameters
    ----------
    field
        The field; the modelled sources are those of ``field.modelled``, in this order.
    response
        Spectra and attenuations of the sources.
    strength
        Flux of a facet over that of the catalogue.
    sources
        The sources with their priors.
    """

    field: Field
    response: Response
    strength: Float[Array, " source"]
    sources: tuple[ModelledSource, ...]

    @classmethod
    def from_field(cls, field: Field, model: Model, declination: float) -> Self:
        """Apply the assumptions about the sources to a field at this declination [rad]."""
        sky = field.sky.select(field.modelled)
        response = Response.from_sky(sky, field.summary.probes, model.attenuation(declination))
        strength = response.strengths(sky)
        median = np.exp(field.size.log_median[field.modelled])
        sources = tuple(
            _modelled_source(field, model, *values)
            for values in zip(
                field.modelled.tolist(), median.tolist(), strength.tolist(), strict=True
            )
        )
        return cls(field, response, strength, sources)

    @property
    def is_galaxy(self) -> Bool[Array, " source"]:
        """Whether each source is a galaxy to be measured; the others are points."""
        return self.field.flags[self.field.modelled] == FitFlag.OK

    @property
    def galaxies(self) -> list[int]:
        """Numbers of the galaxies among the modelled sources."""
        return np.flatnonzero(self.is_galaxy).tolist()

    @property
    def expected(self) -> tuple[GalaxyFit, ...]:
        """The sources as they are assumed to be before anything is fitted."""
        return tuple(source.expected for source in self.sources)

    @property
    def centres(self) -> Float[Array, "source 2"]:
        """Direction cosines of the catalogue, on which facets are centred."""
        return np.column_stack([self.field.l, self.field.m])[self.field.modelled]

    @property
    def median_size(self) -> Float[Array, " source"]:
        """Median of the prior on the scale length [rad]."""
        return np.exp(self.field.size.log_median[self.field.modelled])

    @property
    def strength_at_1_4_ghz(self) -> Float[Array, " source"]:
        """Flux of a facet over the source's flux at 1.4 GHz."""
        sky = self.field.sky.select(self.field.modelled)
        ratio = (REFERENCE_FREQUENCY / sky.reference_frequency) ** sky.spectral_index
        return self.strength / ratio

    def in_catalogue_flux(self, source: int, fit: GalaxyFit) -> GalaxyFit:
        """Return a fit with its flux in the unit of the catalogue."""
        return replace(fit, flux=fit.flux / float(self.strength[source]))

    def sky(self, fits: Sequence[GalaxyFit]) -> Galaxies:
        """Return all sources of the catalogue, with the fitted parameters of those that are modelled."""
        found = {
            int(member): self.in_catalogue_flux(k, fit)
            for k, (member, fit) in enumerate(zip(self.field.modelled, fits, strict=True))
        }
        return with_fitted(self.field.sky, self.field, found)


def _modelled_source(
    field: Field, model: Model, member: int, median_size: float, strength: float
) -> ModelledSource:
    size = float(field.sky.scale_length[member])
    flux = float(field.sky.flux[member]) * strength
    position_sigma = ASTROMETRY * median_size
    if model.position_radius is not None:
        position_sigma = model.position_radius / 2
    elif field.position_err[member] > 0:
        position_sigma = float(field.position_err[member])
    flux_sigma = PHOTOMETRY * flux
    if field.flux_err[member] > 0:
        # A finder has the flux from the same data: taken at its word it would count twice.
        flux_sigma = max(float(field.flux_err[member]) * strength, SUREST_PHOTOMETRY * flux)
    prior = replace(
        field.prior(member, model.position_radius, model.ellipticity),
        ellipticity_sigma=math.sqrt(model.population.population_variance),
        position_sigma=max(position_sigma, LEAST_SIGMA),
        flux=flux,
        flux_sigma=max(flux_sigma, LEAST_SIGMA),
    )
    kind = GalaxySource if field.flags[member] == FitFlag.OK else PointSource
    return kind(prior, model.profile, GalaxyFit(flux, np.zeros(2), 0j, size, 0.0))
