"""The plan of a major cycle: bands of baselines, their tiles, and a cutout for each source."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.imaging.bands import Band, longest_seen, numbers_of_bands, octaves, steepest
from uvshear.imaging.curvature import half_widths_of_bands
from uvshear.imaging.cutout import Cutout, cutout, cutout_size
from uvshear.imaging.tiles import Footprint, Tile, Tiling, plan_tiles
from uvshear.typing import Array, Float, Int

SMALL = 0.67
"""Longest baseline of a facet times a scale length two sigma below the prior's median. For SKA-Mid, the longer
baselines hold 1e-5 of the information on the ellipticity of a galaxy of median size, 5e-4 for a galaxy of half that
size, and 3e-3 for a third of it."""

LADDER = 1.15
"""Ratio of successive widths of facets. There are few widths, so that sources share cells and beams."""


@dataclass(frozen=True)
class FacetRequests:
    """The facets that are requested, one for each source.

    Parameters
    ----------
    l, m
        Direction cosines of the facets' centres.
    width
        Width of each facet [rad].
    informative_uv_max
        Longest baseline of each facet [wavelengths].
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    width: Float[Array, " source"]
    informative_uv_max: Float[Array, " source"]


@dataclass(frozen=True)
class MajorCyclePlan:
    """Bands of baselines, their tiles, and the cutouts of the sources.

    Parameters
    ----------
    shortest, longest
        Range of the baselines that are used [wavelengths].
    bands
        Bands, beginning with the longest baselines.
    tiles
        Tiles of each band.
    cutouts
        Cutout of each source.
    place
        Lattice point at the centre of each cutout, even in both coordinates [finest pixels].
    offset
        Distance from there to the source [rad].
    slope
        Largest slope of n among the sources.
    """

    shortest: float
    longest: float
    bands: tuple[Band, ...]
    tiles: tuple[tuple[Tile, ...], ...]
    cutouts: tuple[Cutout, ...]
    place: Int[Array, "source 2"]
    offset: Float[Array, "source 2"]
    slope: float = 0.0

    @property
    def pixel(self) -> float:
        """Width of the finest pixels [rad]."""
        return self.bands[0].pixel

    @property
    def top(self) -> int:
        """Number of the finest band that holds baselines: 0, or 1 where the longest are left out."""
        return int(len(self.bands) > 1 and self.longest <= self.bands[0].shortest)

    @property
    def has_all_baselines(self) -> bool:
        """Whether the longest baselines are used."""
        return self.top == 0

    @property
    def centres(self) -> Float[Array, "source 2"]:
        """Direction cosines of the sources that the facets are centred on."""
        return self.place * self.pixel + self.offset

    def band_of(self, uvw: Float[Array, "sample 3"]) -> Int[Array, " sample"]:
        """Return the number of the band whose pixels represent each baseline [wavelengths] as all sources see it."""
        return numbers_of_bands(self.bands, longest_seen(uvw, self.slope))


def plan_major_cycle(
    requests: FacetRequests,
    shortest: float,
    longest: float,
    finest: float | None = None,
    tiling: Tiling | None = None,
    baselines: Float[Array, "sample 3"] | None = None,
) -> MajorCyclePlan:
    """Plan for baselines from ``shortest`` to ``longest``, on pixels that can represent ``finest`` [wavelengths].

    Some of the ``baselines`` (u, v, w) limit the widths of tiles far from the phase centre.

    Sources interact on pixels twice as wide as the finest: where an array does not resolve them, these pixels must
    represent all of its baselines, and ``finest`` is up to twice ``longest``.
    """
    finest = max(finest or longest, longest)
    lm = np.column_stack([requests.l, requests.m])
    span = float(np.ptp(lm, axis=0).max(initial=0.0)) + float(requests.width.max(initial=0.0))
    bands = octaves(shortest, finest, span)
    pixel = bands[0].pixel
    steps = np.ceil(np.log(requests.width / pixel) / math.log(LADDER) - 1e-9)
    sizes = [cutout_size(pixel * LADDER**step, pixel) for step in steps]
    reach = np.minimum(requests.informative_uv_max, longest)
    # Cells end on a ladder too, so that sources of about one size share theirs.
    ends = longest * LADDER ** -np.floor(np.log(longest / reach) / math.log(LADDER) + 1e-9)
    cutouts = tuple(
        cutout(size, pixel, shortest, float(end)) for size, end in zip(sizes, ends, strict=True)
    )
    place = 2 * np.rint(lm / (2 * pixel)).astype(int)
    footprint = Footprint(requests.l, requests.m, (np.array(sizes) / 2 + 2) * pixel)
    slope = steepest(requests.l, requests.m)
    limits = None
    if baselines is not None and len(baselines):
        band = numbers_of_bands(bands, longest_seen(baselines, slope))
        radius = float(np.hypot(requests.l, requests.m).max(initial=0.0))
        limits = half_widths_of_bands(baselines, band, len(bands), radius)
    tiles = plan_tiles(footprint, pixel, len(bands), tiling, limits)
    offset = lm - place * pixel
    return MajorCyclePlan(shortest, longest, bands, tiles, cutouts, place, offset, slope)
