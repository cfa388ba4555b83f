"""What a visit of the visibilities is to bring: bands, tiles, and a cutout for each source."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.imaging.bands import Band, octaves
from uvshear.imaging.cutout import Cutout, cutout, cutout_size
from uvshear.imaging.tiles import Footprint, Tile, plan_tiles
from uvshear.typing import Array, Float, Int

SMALL = 0.67
"""Longest baseline of a facet times a scale length two sigma below the prior's median. For SKA-Mid, what is left
out is 1e-5 of the information on the ellipticity of a galaxy of median size, 5e-4 for half of that, 3e-3 for a
third of it."""

LADDER = 1.15
"""Ratio of neighbouring widths: few, so that sources share cells and beams."""


@dataclass(frozen=True)
class Wanted:
    """What is wanted of each source; positions are those that facets are centred on.

    Parameters
    ----------
    l, m
        Direction cosines.
    width
        Of the facet [rad].
    informative_uv_max
        Longest baseline of the facet [wavelengths].
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    width: Float[Array, " source"]
    informative_uv_max: Float[Array, " source"]


@dataclass(frozen=True)
class VisitPlan:
    """Bands of baselines, their tiles, and the cutouts of the sources.

    Parameters
    ----------
    shortest, longest
        Of the baselines that take part [wavelengths].
    bands
        From the longest baselines down.
    tiles
        Of each band.
    cutouts
        Of each source.
    place
        Lattice point (finest pixels) in the middle of each cutout, even in both coordinates.
    offset
        From there to the source [rad].
    """

    shortest: float
    longest: float
    bands: tuple[Band, ...]
    tiles: tuple[tuple[Tile, ...], ...]
    cutouts: tuple[Cutout, ...]
    place: Int[Array, "source 2"]
    offset: Float[Array, "source 2"]

    @property
    def pixel(self) -> float:
        """The finest [rad]."""
        return self.bands[0].pixel

    @property
    def top(self) -> int:
        """Number of the finest band that holds baselines: 0, or 1 where the longest are left out."""
        return int(len(self.bands) > 1 and self.longest <= self.bands[0].shortest)

    def band_of(self, distance: Float[Array, " sample"]) -> Int[Array, " sample"]:
        """Tell the number of the band of each uv distance [wavelengths]."""
        edges = [band.shortest for band in self.bands[:-1]][::-1]
        return len(edges) - np.searchsorted(edges, distance, side="right")


def plan_visit(
    wanted: Wanted, shortest: float, longest: float, finest: float | None = None
) -> VisitPlan:
    """Plan for baselines from ``shortest`` to ``longest``, and pixels for ones as long as ``finest`` [wavelengths].

    Sources interact on pixels twice as wide as the finest: where an array does not resolve them, all of its baselines
    belong there, and ``finest`` is up to twice ``longest``.
    """
    finest = max(finest or longest, longest)
    lm = np.column_stack([wanted.l, wanted.m])
    span = float(np.ptp(lm, axis=0).max(initial=0.0)) + float(wanted.width.max(initial=0.0))
    bands = octaves(shortest, finest, span)
    pixel = bands[0].pixel
    steps = np.ceil(np.log(wanted.width / pixel) / math.log(LADDER) - 1e-9)
    sizes = [cutout_size(pixel * LADDER**step, pixel) for step in steps]
    reach = np.minimum(wanted.informative_uv_max, longest)
    # Cells end on a ladder too: sources of about one size share theirs.
    ends = longest * LADDER ** -np.floor(np.log(longest / reach) / math.log(LADDER) + 1e-9)
    cutouts = tuple(
        cutout(size, pixel, shortest, float(end)) for size, end in zip(sizes, ends, strict=True)
    )
    place = 2 * np.rint(lm / (2 * pixel)).astype(int)
    footprint = Footprint(wanted.l, wanted.m, (np.array(sizes) / 2 + 2) * pixel)
    tiles = plan_tiles(footprint, pixel, len(bands))
    return VisitPlan(shortest, longest, bands, tiles, cutouts, place, lm - place * pixel)
