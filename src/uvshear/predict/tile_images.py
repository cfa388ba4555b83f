"""The image of some galaxies in the frame of their middle, and their visibilities."""

import math
from dataclasses import dataclass

import numpy as np

from uvshear.constants import SPEED_OF_LIGHT
from uvshear.galaxy import Galaxies, Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.geometry.tangent_frame import TangentFrame
from uvshear.imaging.bands import Band
from uvshear.imaging.grid import ImageGrid
from uvshear.imaging.gridder import degrid
from uvshear.imaging.tiles import Tile
from uvshear.predict.drawable import stamp_sizes
from uvshear.predict.rendering import Stamps, draw
from uvshear.typing import Array, Complex, Float

EPSILON = 2e-6
"""Relative error of the gridder."""

STEEPNESS = 14.0
"""Shape parameter of the taper between the longest baseline and the Nyquist frequency."""


@dataclass(frozen=True)
class TileImage:
    """Image of the galaxies of a tile, in the frame of its centre, and their spectrum."""

    frame: TangentFrame
    image: Float[Array, "l m"]
    grid: ImageGrid
    spectrum: Float[Array, " chan"]

    def visibilities(
        self, uvw: Float[Array, "row 3"], frequency: Float[Array, " chan"]
    ) -> Complex[Array, "row chan"]:
        """Visibilities of the tile [Jy] for baselines in metres."""
        vis = degrid(
            self.frame.baselines(uvw),
            frequency,
            self.image,
            self.grid,
            epsilon=EPSILON,
            with_w=True,
        )
        turns = np.outer(self.frame.turns(uvw), frequency / SPEED_OF_LIGHT)
        return vis * (np.exp(2j * math.pi * (turns - np.rint(turns))) * self.spectrum)


def draw_tile(
    galaxies: Galaxies,
    flux: Float[Array, " source"],
    spectrum: Float[Array, " chan"],
    band: Band,
    profile: Profile,
) -> TileImage:
    """Draw galaxies on a tile about their middle."""
    middle = [float(x.min() + x.max()) / 2 for x in (galaxies.l, galaxies.m)]
    frame = TangentFrame.at(*middle)
    place = np.column_stack(frame.directions(galaxies.l, galaxies.m))
    forms = np.stack(quadratic_form(galaxies.ellipticity, galaxies.scale_length), axis=-1)
    forms = frame.forms(galaxies.l, galaxies.m, forms)
    sizes = stamp_sizes(galaxies, band.pixel, profile).astype(int)
    nearest = np.rint(place / band.pixel).astype(int)
    half = sizes[:, None] // 2 + 1
    # The centre of the frame is the middle pixel.
    size = 2 * int(np.max(np.abs(nearest) + half))
    tile = Tile(0, (-size // 2, -size // 2), size, np.arange(len(galaxies)), -1)
    image = draw(Stamps(place, forms, flux, sizes.tolist(), STEEPNESS), tile, band, profile)
    return TileImage(frame, image, ImageGrid(size, band.pixel), spectrum)
