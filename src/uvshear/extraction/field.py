"""The sources of a catalogue, prepared for a measurement."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.galaxy import EllipticityPrior, Galaxies, SizePrior
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.summary import ObservationSummary
from uvshear.interferometer.uv_range import UvRange
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.prior import ShapePrior
from uvshear.typing import Array, Bool, Float, Int, Shaped

_NANORADIAN = 1e-9


@dataclass(frozen=True)
class Field:
    """The sources of a catalogue; those that cannot be measured have a flag other than OK.

    Parameters
    ----------
    l, m
        Direction cosines of the catalogue's positions, on which facets are centred.
    sky
        The sources as they are assumed to be before anything is fitted.
    size
        Prior of each source's scale length.
    modelled
        Sources that are subtracted, as indices of the catalogue.
    flags
        A :class:`FitFlag` for each source.
    uv_range
        Baselines that are used; the longest is finite.
    summary
        Summary of the observation.
    flux_err, position_err
        Errors of the catalogue's fluxes [Jy] and positions along each axis [rad], 0 where they are not known.
    weight_correction
        Information on the shape of each source over the information that the weights imply; 1 for natural weights,
        which are 1/sigma^2.
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    sky: Galaxies
    size: SizePrior
    modelled: Int[Array, " member"]
    flags: Shaped[Array, " source"]
    uv_range: UvRange
    summary: ObservationSummary
    flux_err: Float[Array, " source"]
    position_err: Float[Array, " source"]
    weight_correction: Float[Array, " source"]

    @property
    def measured(self) -> Int[Array, " member"]:
        """Sources to be fitted, as indices of the catalogue."""
        return np.flatnonzero(self.flags == FitFlag.OK)

    def without(self, left_out: Bool[Array, " member"], flag: FitFlag) -> Self:
        """Return the field without some of its modelled sources, which get a flag."""
        members = self.modelled[left_out]
        if len(members) == 0:
            return self
        flags, flux = self.flags.copy(), self.sky.flux.copy()
        flags[members], flux[members] = flag, 0.0
        return replace(
            self,
            flags=flags,
            sky=replace(self.sky, flux=flux),
            modelled=self.modelled[~left_out],
        )

    def name(self, source: int, centre: PhaseCentre) -> tuple[int, ...]:
        """Return numbers that identify a source among those of all fields: directions in nanoradians."""
        angles = centre.ra, centre.dec, float(self.l[source]), float(self.m[source])
        return tuple(round(angle / _NANORADIAN) % 2**32 for angle in angles)

    def prior(
        self, source: int, position_radius: float | None, ellipticity: EllipticityPrior
    ) -> ShapePrior:
        """Return the prior of a source, with the field's prior on its size."""
        return ShapePrior(
            log_scale_length=float(self.size.log_median[source]),
            log_scale_length_sigma=float(self.size.sigma[source]),
            position_radius=position_radius,
            ellipticity=ellipticity,
        )
