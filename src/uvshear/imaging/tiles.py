"""Tiles over the sky: each band has tiles of its own, and a tile of a coarse band covers several of the finer one.

The pixels of all tiles lie on one lattice: pixel (i, j) of band b is at l = i 2^b p, m = j 2^b p, with p the pixel of
band 0. A tile is imaged in the plane tangent at its centre, where w hardly matters.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from uvshear.typing import Array, Float, Int

WIDEST = 3584
"""Largest number of pixels of the finest band that a tile covers along a side, without its margins. With fewer, the
margins and the samples cost time, and with more, w and memory do."""

TAPS = 8
"""Number of coarse pixels beyond a tile that interpolation to its pixels needs."""


MOST_JOINED = 60
"""Number of times that boxes can be joined: numbers of boxes have 64 bits."""


@dataclass(frozen=True)
class Tile:
    """A square of pixels of one band.

    Parameters
    ----------
    band
        Number of the band, counted from the finest.
    origin
        Lattice point of the first pixel.
    size
        Number of pixels along a side.
    members
        Sources in the tile.
    parent
        Index of the tile of the next coarser band that covers this one, -1 in the coarsest band.
    """

    band: int
    origin: tuple[int, int]
    size: int
    members: Int[Array, " member"]
    parent: int

    def centre(self, pixel: float) -> tuple[float, float]:
        """Direction cosines of pixel (size/2, size/2), for pixels of this width [rad]."""
        half = self.size // 2
        return (self.origin[0] + half) * pixel, (self.origin[1] + half) * pixel


@dataclass(frozen=True)
class Tiling:
    """How tiles divide a field.

    Parameters
    ----------
    width
        Largest number of pixels of the finest band that a tile of this band covers along a side, without its margins.
    unjoined
        Number of bands, beginning with the finest, whose tiles divide the field into the same parts. In each of the
        coarser bands a tile covers two by two tiles of the next finer one.
    """

    width: int = field(default_factory=lambda: WIDEST)
    unjoined: int = 1


@dataclass(frozen=True)
class Footprint:
    """Squares of sky, one for each source, that tiles must hold.

    Parameters
    ----------
    l, m
        Direction cosines of the source.
    half_width
        Half of the width of its facet [rad].
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    half_width: Float[Array, " source"]


def plan_tiles(
    footprint: Footprint,
    pixel: float,
    bands: int,
    tiling: Tiling | None = None,
    half_widths: Sequence[float] | None = None,
) -> tuple[tuple[Tile, ...], ...]:
    """Plan the tiles of each band, beginning with the finest; parts of the sky without sources have none.

    Parameters
    ----------
    footprint
        Squares of sky that the tiles must hold.
    pixel
        Width of the pixels of the finest band [rad].
    bands
        Number of bands.
    tiling
        How the tiles divide the field; into as few as possible unless given.
    half_widths
        Half of the width that a tile of each band may have without its margins [rad]; no limit unless given.
    """
    tiling = tiling or Tiling()
    widest = min(tiling.width * pixel, 2 * min(half_widths or [math.inf]))
    boxes, box = _boxes(footprint, widest)
    joined = _joined(half_widths or [math.inf] * bands, box, tiling.unjoined)
    plans: list[tuple[Tile, ...]] = []
    children: dict[tuple[int, int], list[Tile]] = {}
    previous: list[list[int]] = []
    step = 0
    for band in range(bands):
        keys, index = np.unique(boxes >> joined[band], axis=0, return_inverse=True)
        index = index.ravel()
        tiles = [
            _tile(footprint, pixel, band, np.flatnonzero(index == k), children.get(tuple(key), []))
            for k, key in enumerate(keys.tolist())
        ]
        if band:
            parents = {tuple(key): k for k, key in enumerate(keys.tolist())}
            plans[-1] = tuple(
                _with_parent(tile, parents[(key[0] >> step, key[1] >> step)])
                for tile, key in zip(plans[-1], previous, strict=True)
            )
        plans.append(tuple(tiles))
        previous = keys.tolist()
        step = joined[min(band + 1, bands - 1)] - joined[band]
        children = {}
        for tile, (a, b) in zip(tiles, previous, strict=True):
            children.setdefault((a >> step, b >> step), []).append(tile)
    return tuple(plans)


def _boxes(footprint: Footprint, widest: float) -> tuple[Int[Array, "source 2"], float]:
    """Box of each source, and the width of a box; the boxes divide the field into equal parts of at most ``widest``."""
    lm = np.column_stack([footprint.l, footprint.m])
    low, extent = lm.min(axis=0), np.ptp(lm, axis=0)
    parts = np.maximum(1, np.ceil(extent / widest))
    place = np.floor((lm - low) / np.where(extent > 0, extent, 1.0) * parts)
    return np.minimum(place, parts - 1).astype(int), float((extent / parts).max())


def _joined(half_widths: Sequence[float], box: float, unjoined: int) -> list[int]:
    """Return how often boxes are joined, two by two along each axis, in the tiles of each band: at most once a band."""
    joined = [0]
    for band in range(1, len(half_widths)):
        # Coarser bands have the boxes of this one, or larger ones, and therefore limit it.
        ratio = 2 * min(half_widths[band:]) / box if box > 0 else math.inf
        most = math.floor(math.log2(min(max(ratio, 1.0), 2.0**MOST_JOINED)) + 1e-9)
        joined.append(min(joined[-1] + int(band >= unjoined), most))
    return joined


def _tile(
    footprint: Footprint,
    pixel: float,
    band: int,
    members: Int[Array, " member"],
    children: list[Tile],
) -> Tile:
    step = pixel * 2**band
    low, high = [], []
    for x in (footprint.l[members], footprint.m[members]):
        half = footprint.half_width[members]
        low.append(math.floor(float((x - half).min()) / step) - 2)
        high.append(math.ceil(float((x + half).max()) / step) + 2)
    for child in children:
        for axis in (0, 1):
            first, last = child.origin[axis], child.origin[axis] + child.size
            low[axis] = min(low[axis], first // 2 - TAPS)
            high[axis] = max(high[axis], last // 2 + 1 + TAPS)
    size = max(high[0] - low[0], high[1] - low[1], 64)
    size += size % 2
    return Tile(band, square_around(low, high, size), size, members, -1)


def square_around(low: Sequence[int], high: Sequence[int], size: int) -> tuple[int, int]:
    """Return the first pixel of a square of ``size`` pixels that has the middle of a rectangle at its centre."""
    first, second = (
        start - (size - (stop - start)) // 2 for start, stop in zip(low, high, strict=True)
    )
    return first, second


def _with_parent(tile: Tile, parent: int) -> Tile:
    return Tile(tile.band, tile.origin, tile.size, tile.members, parent)
