"""Planner of the major cycles of a measurement: wide enough facets, and the rough cycles first."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.beams import SIZE, BeamPlan
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.plan import FacetRequests, MajorCyclePlan, plan_major_cycle
from uvshear.extraction.converged.reach import used_baselines
from uvshear.extraction.converged.tile_sizes import fastest_tiling
from uvshear.galaxy import Galaxies
from uvshear.imaging.bands import OVERSAMPLING
from uvshear.imaging.tiles import Tiling
from uvshear.predict.gridded import ModelledSky
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float

POINT_STAMP = 128
"""Width to which a point source is drawn [finest pixels]: its image rings out to the scale of the taper."""

WIDEST = 0.8
"""Largest width of a facet, over that of the beams."""


@dataclass(frozen=True)
class Planner:
    """Plans the major cycles of a field.

    Parameters
    ----------
    modelled
        The modelled sources.
    baselines
        Baselines that are used.
    scale_lengths
        Width of a facet over the median scale length; facets are wider for galaxies that turn out to be larger.
    tiling
        How tiles divide the field; into as few as possible unless given.
    """

    modelled: ModelledField
    baselines: Baselines
    scale_lengths: float
    tiling: Tiling | None = None

    @classmethod
    def from_field(
        cls, modelled: ModelledField, baselines: Baselines, scale_lengths: float, epsilon: float
    ) -> Self:
        """Choose the tiles for the sources as they are expected; ``epsilon`` is the relative error of the gridder."""
        large = cls(modelled, baselines, scale_lengths)
        used = baselines.shortest, baselines.longest, baselines.finest
        tiling = fastest_tiling(
            large._requests(modelled.expected),
            used,
            large._sources,
            modelled.response,
            modelled.field.summary,
            epsilon,
        )
        return replace(large, tiling=tiling)

    @property
    def pixel(self) -> float:
        """Width of the finest pixels [rad]."""
        return 1 / (2 * OVERSAMPLING * self.baselines.finest)

    def plan(self, fits: Sequence[GalaxyFit]) -> MajorCyclePlan:
        """Plan a major cycle with all baselines."""
        return self._planned(fits, self.baselines.longest)

    def plan_roughly(self, fits: Sequence[GalaxyFit]) -> MajorCyclePlan:
        """Plan a major cycle without the longest baselines, the most expensive ones, if there are several bands."""
        plan = self.plan(fits)
        if len(plan.bands) == 1:
            return plan
        return self._planned(fits, min(plan.bands[0].shortest, self.baselines.longest))

    def plan_beams(self) -> BeamPlan:
        """Plan the beams around the sources."""
        used, response = self.baselines, self.modelled.response
        return BeamPlan.around(self._sources, response, used.shortest, used.longest, self.pixel)

    def subtracted(self, fits: Sequence[GalaxyFit]) -> ModelledSky:
        """Return the sky that a major cycle subtracts, with the distance to which each source is drawn."""
        modelled = self.modelled
        half = np.array([fit.half_width for fit in fits])
        half = np.maximum(half, self.scale_lengths / 2 * modelled.median_size)
        half = np.where(modelled.is_galaxy, half, POINT_STAMP / 2 * self.pixel)
        sky = modelled.sky(fits).select(modelled.field.modelled)
        return ModelledSky(sky, half, modelled.response, modelled.sources[0].profile)

    def _planned(self, fits: Sequence[GalaxyFit], longest: float) -> MajorCyclePlan:
        used, requests = self.baselines, self._requests(fits)
        return plan_major_cycle(
            requests, used.shortest, longest, used.finest, self.tiling, self._probes
        )

    @cached_property
    def _probes(self) -> Float[Array, "sample 3"]:
        return used_baselines(self.modelled.field, self.baselines.longest)

    @property
    def _sources(self) -> Galaxies:
        return self.modelled.field.sky.select(self.modelled.field.modelled)

    def _requests(self, fits: Sequence[GalaxyFit]) -> FacetRequests:
        l, m = self.modelled.centres.T
        return FacetRequests(l, m, self._widths(fits), self.baselines.uv_max)

    def _widths(self, fits: Sequence[GalaxyFit]) -> Float[Array, " source"]:
        is_galaxy = self.modelled.is_galaxy
        least = self.scale_lengths * self.modelled.median_size
        narrowest = float(least[is_galaxy].min()) if is_galaxy.any() else math.inf
        width = np.maximum(least, [2 * fit.half_width for fit in fits])
        width = np.where(is_galaxy, width, narrowest)
        return np.minimum(width, WIDEST * SIZE * self.pixel)
