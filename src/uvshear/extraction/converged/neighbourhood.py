"""Positions of the sources of a field, and which of them are neighbours."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.spatial import cKDTree

from uvshear.constants import ARCSEC
from uvshear.extraction.converged.groups import overlapping_groups
from uvshear.extraction.schedule import fitting_levels
from uvshear.typing import Array, Bool, Float, Int

SEPARATION = 60 * ARCSEC
"""Sources closer than this are fitted one after the other, the brighter first."""

NEAR = 15 * ARCSEC
"""Distance up to which a source is fitted again when its neighbour has changed, and up to which neighbours count in the
errors of a source."""

Units = list[list[int]]
"""Sources that are fitted together: groups that overlap, and single ones."""


@dataclass(frozen=True)
class Neighbourhood:
    """Positions of the sources, and the groups that overlap.

    Parameters
    ----------
    place
        Direction cosines.
    flux
        Expected fluxes [Jy], which order the fits of neighbours.
    units
        Groups of sources that overlap, and single ones.
    """

    place: Float[Array, "source 2"]
    flux: Float[Array, " source"]
    units: Units
    _tree: cKDTree

    @classmethod
    def from_sizes(
        cls,
        place: Float[Array, "source 2"],
        flux: Float[Array, " source"],
        scale_length: Float[Array, " source"],
    ) -> Self:
        """Find the groups of sources of these sizes [rad]."""
        return cls(place, flux, overlapping_groups(place, scale_length), cKDTree(place))

    @property
    def is_grouped(self) -> Bool[Array, " source"]:
        """Whether each source is a member of a group."""
        grouped = np.zeros(len(self.place), bool)
        grouped[[source for unit in self.units if len(unit) > 1 for source in unit]] = True
        return grouped

    @property
    def singles(self) -> Units:
        """Every source as a unit of its own."""
        return [[source] for source in range(len(self.place))]

    def around(self, sources: Int[Array, " chosen"]) -> Bool[Array, " source"]:
        """Whether each source is one of the given sources or near one of them."""
        near = np.zeros(len(self.place), bool)
        for neighbours in self._tree.query_ball_point(self.place[sources], NEAR):
            near[neighbours] = True
        return near

    def nearest_to(self, source: int) -> list[int]:
        """Return the neighbours of a source, the nearest first."""
        near = self._tree.query_ball_point(self.place[source], NEAR)
        others = [other for other in near if other != source]
        if not others:
            return others
        apart = np.hypot(*(self.place[others] - self.place[source]).T)
        return [others[k] for k in np.argsort(apart, kind="stable")]

    def levels(self, units: Sequence[list[int]]) -> Iterable[Units]:
        """Sort units by level: each comes after all brighter units near it, and the units of a level are far apart."""
        if not units:
            return
        centres = np.array([self.place[unit].mean(axis=0) for unit in units])
        flux = np.array([self.flux[unit].max() for unit in units])
        for level in fitting_levels(centres, flux, SEPARATION):
            yield [units[k] for k in level.tolist()]
