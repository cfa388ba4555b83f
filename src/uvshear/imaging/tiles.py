"""Tiles over the sky: each band has its own, those of a coarse band over several of the finer one.

Pixels of all tiles lie on one lattice: pixel (i, j) of band b is at l = i 2^b p, m = j 2^b p, with p the pixel
of band 0. A tile is imaged in the plane tangent at its centre, where its w is small.
"""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.typing import Array, Float, Int

CORE = 3072
"""Pixels of the finest band that a tile covers besides its margins: fewer make margins cost, more make w cost."""

TAPS = 8
"""Coarse pixels that interpolation reaches beyond the tile it fills."""


@dataclass(frozen=True)
class Tile:
    """A square of pixels of band ``band``, the first of them at lattice point ``origin``.

    ``members`` are the sources in it; ``parent`` is the place in the next coarser band's list of the tile that
    covers it, -1 in the coarsest band.
    """

    band: int
    origin: tuple[int, int]
    size: int
    members: Int[Array, " member"]
    parent: int

    def centre(self, pixel: float) -> tuple[float, float]:
        """Direction cosines of pixel (size/2, size/2)."""
        half = self.size // 2
        return (self.origin[0] + half) * pixel, (self.origin[1] + half) * pixel


@dataclass(frozen=True)
class Footprint:
    """What tiles must hold of each source.

    Parameters
    ----------
    l, m
        Direction cosines.
    half_width
        Of its facet [rad].
    """

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    half_width: Float[Array, " source"]


def plan_tiles(footprint: Footprint, pixel: float, bands: int) -> tuple[tuple[Tile, ...], ...]:
    """Tiles of each band, from the finest on; only places with sources have any."""
    boxes = _boxes(footprint, pixel)
    plans: list[tuple[Tile, ...]] = []
    children: dict[tuple[int, int], list[Tile]] = {}
    previous: list[list[int]] = []
    for band in range(bands):
        keys, index = np.unique(boxes >> band, axis=0, return_inverse=True)
        index = index.ravel()
        tiles = [
            _tile(footprint, pixel, band, np.flatnonzero(index == k), children.get(tuple(key), []))
            for k, key in enumerate(keys.tolist())
        ]
        if band:
            parents = {tuple(key): k for k, key in enumerate(keys.tolist())}
            plans[-1] = tuple(
                _with_parent(tile, parents[(key[0] >> 1, key[1] >> 1)])
                for tile, key in zip(plans[-1], previous, strict=True)
            )
        plans.append(tuple(tiles))
        previous = keys.tolist()
        children = {}
        for tile, (a, b) in zip(tiles, previous, strict=True):
            children.setdefault((a >> 1, b >> 1), []).append(tile)
    return tuple(plans)


def _boxes(footprint: Footprint, pixel: float) -> Int[Array, "source 2"]:
    """Box of each source: the field in equal parts of at most ``CORE`` pixels."""
    lm = np.column_stack([footprint.l, footprint.m])
    low, extent = lm.min(axis=0), np.ptp(lm, axis=0)
    parts = np.maximum(1, np.ceil(extent / (CORE * pixel)))
    place = np.floor((lm - low) / np.maximum(extent, pixel) * parts)
    return np.minimum(place, parts - 1).astype(int)


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
    return Tile(band, (low[0], low[1]), size, members, -1)


def _with_parent(tile: Tile, parent: int) -> Tile:
    return Tile(tile.band, tile.origin, tile.size, tile.members, parent)
