"""Matched filters of the sources of each tile, in terms of a few.

The facet of a source is gathered with the source's own filter (``Response.matched_filter``), as if its samples had been
imaged for it alone. The filters of the sources of a tile are combinations of those of a few, so that a few images of
the tile are enough. On baselines of coarser bands, these few are combinations of the filters of the coarser tile.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.galaxy import Galaxies
from uvshear.imaging.tiles import Tile
from uvshear.predict.response import Response, SeenAs, seen_as
from uvshear.typing import Array, Float, Int


@dataclass(frozen=True)
class TileFilters:
    """Matched filters of the sources of one tile.

    Parameters
    ----------
    chosen
        Sources whose filters the images of the tile have.
    seen_as
        What the filter of each of these depends on.
    members
        Sources of the tile, in rising order.
    shares
        Share of each image in the facet of each member.
    """

    chosen: Int[Array, " image"]
    seen_as: tuple[SeenAs, ...]
    members: Int[Array, " member"]
    shares: Float[Array, "image member"]

    @classmethod
    def from_tile(
        cls, tile: Tile, galaxies: Galaxies, response: Response, shortest: float, longest: float
    ) -> Self:
        """Choose the filters of a tile for baselines within a range [wavelengths]."""
        members = np.sort(tile.members)
        inside = galaxies.select(members)
        shared = response.shared_filters(inside, shortest, longest)
        return cls(
            chosen=members[shared.chosen],
            seen_as=tuple(seen_as(inside, source) for source in shared.chosen.tolist()),
            members=members,
            shares=shared.coefficients.astype(np.float32),
        )

    def mixed(self, images: Sequence[Float[Array, "l m"]], source: int) -> Float[Array, "l m"]:
        """Mix the images of the tile, or the same part of each, for a source of the tile."""
        shares = self.shares[:, np.searchsorted(self.members, source)]
        if len(images) == 1 and shares[0] == 1:
            return images[0]
        total = shares[0] * images[0]
        for share, image in zip(shares[1:], images[1:], strict=True):
            total += share * image
        return total


def filters_of_plan(
    plan: MajorCyclePlan, galaxies: Galaxies, response: Response
) -> tuple[tuple[TileFilters, ...], ...]:
    """Choose the filters of every tile of every band.

    The filters of a tile serve its band and all coarser ones, whose images are added to its own.
    """
    return tuple(
        tuple(
            TileFilters.from_tile(tile, galaxies, response, plan.shortest, band.longest)
            for tile in tiles
        )
        for band, tiles in zip(plan.bands, plan.tiles, strict=True)
    )
