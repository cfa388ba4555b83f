"""Visibilities of many galaxies by way of images: the galaxies are drawn on tiles, which are degridded."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Galaxies, Profile
from uvshear.imaging.bands import Band
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Tile
from uvshear.interferometer.samples import Samples
from uvshear.predict.rendering import render, stamp_size
from uvshear.predict.response import Response, SeenAs, seen_as
from uvshear.typing import Array, Complex, Float

SLAB = 2**21
"""Number of samples that one call of the gridder takes; it depends on the data alone, so that sums do not depend on the
executor."""

BYTES_PER_SAMPLE = 160
"""Memory for each sample that is processed: the sample, its model, and its baseline in the planes of two tiles."""

LEAST_BLOCK = 2**16
"""Smallest number of samples in a block, however little memory is available."""


@dataclass(frozen=True)
class Gridding:
    """Accuracy of the gridder, and its resources.

    Parameters
    ----------
    epsilon
        Relative error of the gridder.
    block
        Number of samples held in memory at a time.
    executor
        Executor for tiles and slabs of samples.
    """

    epsilon: float = 1e-4
    block: int = 2**24
    executor: Executor = SERIAL


@dataclass(frozen=True)
class ModelledSky:
    """Galaxies to be predicted.

    Parameters
    ----------
    galaxies
        The galaxies, with their fluxes at the reference frequency.
    half_width
        Distance from its centre up to which each galaxy is drawn [rad].
    response
        Spectrum and attenuation of each galaxy over the samples.
    profile
        Brightness profile of all galaxies.
    """

    galaxies: Galaxies
    half_width: Float[Array, " source"]
    response: Response
    profile: Profile


def block_of(memory: float) -> int:
    """Choose the number of samples in a block, which may take a third of this memory [bytes]."""
    return max(int(memory / 3 / BYTES_PER_SAMPLE), LEAST_BLOCK)


def slabs(samples: int) -> list[slice]:
    """Divide samples into parts of at most ``SLAB``, as equal as can be."""
    count = max(1, -(-samples // SLAB))
    edges = [samples * k // count for k in range(count + 1)]
    return [slice(*pair) for pair in pairwise(edges)]


def predict_samples(
    samples: Samples,
    tiles: Sequence[Tile],
    band: Band,
    sky: ModelledSky,
    gridding: Gridding,
) -> Complex[Array, " sample"]:
    """Predict the visibilities of the sky for samples of a band [Jy], by way of images on its tiles."""
    model = np.zeros(len(samples), np.complex64)
    response = sky.response

    def draw(part: _Part) -> Float[Array, "l m"]:
        members = part.tile.members
        return render(
            sky.galaxies.select(members),
            part.flux,
            sky.half_width[members],
            part.tile,
            band,
            sky.profile,
        )

    def predict(
        task: tuple[_Part, Float[Array, "l m"], slice],
    ) -> tuple[slice, Complex[Array, " slab"]]:
        part, image, rows = task
        plane = TangentPlane.at(samples.uvw[rows], *part.tile.centre(band.pixel))
        vis = plane.visibilities(image, band.pixel, gridding.epsilon)
        return rows, vis * response.source_factor(samples.select(rows), *part.seen_as)

    parts = [part for tile in tiles for part in _parts(_padded(tile, sky, band), sky, band)]
    drawn = zip(parts, gridding.executor.map(draw, parts), strict=True)
    tasks = ((part, image, rows) for part, image in drawn for rows in slabs(len(samples)))
    for rows, vis in gridding.executor.map(predict, tasks):
        model[rows] += vis
    return model * response.gain(samples.frequency)


@dataclass(frozen=True)
class _Part:
    """Fluxes of a tile's members [Jy], with the sample factors of a source at (l, m) of one spectral index."""

    tile: Tile
    flux: Float[Array, " member"]
    seen_as: SeenAs


def _parts(tile: Tile, sky: ModelledSky, band: Band) -> list[_Part]:
    members = sky.galaxies.select(tile.members)
    shared = sky.response.shared_factors(members, band.shortest, band.longest)
    parts = []
    for source, coefficients in zip(shared.chosen.tolist(), shared.coefficients, strict=True):
        parts.append(_Part(tile, members.flux * coefficients, seen_as(members, source)))
    return parts


def _padded(tile: Tile, sky: ModelledSky, band: Band) -> Tile:
    """Widen a tile so that it holds the stamps of its members at their present places."""
    half = [stamp_size(float(x), band.pixel) // 2 + 1 for x in sky.half_width[tile.members]]
    low, high = [], []
    for x in (sky.galaxies.l, sky.galaxies.m):
        place = np.rint(x[tile.members] / band.pixel).astype(int)
        low.append(int((place - half).min()))
        high.append(int((place + half).max()))
    size = max(high[0] - low[0], high[1] - low[1])
    size += size % 2
    return Tile(tile.band, (low[0], low[1]), size, tile.members, tile.parent)
