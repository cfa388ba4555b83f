"""A catalogue as a measurement sees it."""

from dataclasses import dataclass

import numpy as np

from uvshear.extraction.paper.facets import Target
from uvshear.galaxy import EllipticityPrior, Galaxies, SizePrior
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.summary import ObservationSummary
from uvshear.interferometer.uv_range import UvRange
from uvshear.shapes.measurement import FitFlag, GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Float, Int, Shaped

_NANORADIAN = 1e-9


@dataclass(frozen=True)
class Field:
    """The sources of a catalogue; those that cannot be measured have a flag other than OK.

    Parameters
    ----------
    l, m
        Positions of the catalogue; facets are centred on them.
    sky
        What the sources look like before anything is fitted.
    size
        Prior of each source's scale length.
    modelled
        Sources that are subtracted, as indices of the catalogue.
    flags
        A :class:`FitFlag` a source.
    uv_range
        Baselines that take part, the longest finite.
    extent
        What the observation holds.
    flux_err, position_err
        Errors of the catalogue's fluxes [Jy] and positions along each axis [rad], 0 where they are not known.
    trust
        What a source's shape is known to, over what the weights say: 1 of natural weights, whose errors the beam tells.
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    sky: Galaxies
    size: SizePrior
    modelled: Int[Array, " member"]
    flags: Shaped[Array, " source"]
    uv_range: UvRange
    extent: ObservationSummary
    flux_err: Float[Array, " source"]
    position_err: Float[Array, " source"]
    trust: Float[Array, " source"]

    @property
    def measured(self) -> Int[Array, " member"]:
        """Sources to be fitted, as indices of the catalogue."""
        return np.flatnonzero(self.flags == FitFlag.OK)

    def name(self, source: int, centre: PhaseCentre) -> tuple[int, ...]:
        """Numbers that tell a source from all others, of other fields too: directions in nanoradians."""
        angles = centre.ra, centre.dec, float(self.l[source]), float(self.m[source])
        return tuple(round(angle / _NANORADIAN) % 2**32 for angle in angles)

    def target(self, source: int, fit: GalaxyFit | None = None) -> Target:
        """Tell what to cut out of the visibilities for a source; ``fit`` is what is known of it."""
        return Target(
            galaxy=self.sky.select(np.array([source])),
            scale_length=float(np.exp(self.size.log_median[source])),
            uv_range=self.uv_range,
            frequency=self.extent.frequency,
            half_width=fit.half_width if fit else 0.0,
        )

    def prior(
        self, source: int, position_radius: float | None, ellipticity: EllipticityPrior
    ) -> ShapePrior:
        """Prior of a source; that of its size is the field's."""
        return ShapePrior(
            log_scale_length=float(self.size.log_median[source]),
            log_scale_length_sigma=float(self.size.sigma[source]),
            position_radius=position_radius,
            ellipticity=ellipticity,
        )
