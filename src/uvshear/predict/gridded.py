"""Visibilities of many galaxies by way of images: the galaxies are drawn on tiles, which are degridded."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from typing import Self, TypeAlias, TypeVar

import numpy as np

from uvshear.errors import InputError
from uvshear.execution import SERIAL, Executor, Promise, Resources
from uvshear.galaxy import Galaxies, Profile
from uvshear.imaging.bands import Band
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Tile, square_around
from uvshear.interferometer.samples import Samples
from uvshear.predict.rendering import render, stamp_size
from uvshear.predict.response import Response, SeenAs, seen_as
from uvshear.typing import Array, Complex, Float

Value = TypeVar("Value")

SLAB = 2**21
"""Number of samples that one call of the gridder takes; it depends on the data alone, so that sums do not depend on the
executor."""

BLOCK = 2**23
"""Number of samples that are imaged before facets are cut out: those of the square degree of the paper are one block,
and take 1.3 GB at most. All galaxies are drawn, and all images transformed, once for each block. The number depends
neither on the memory nor on the executor: the gridder is right to 1e-4, and other blocks would have other errors, which
moves shapes by 5e-5 of their errors and a response of metacalibration by 0.01 of itself. For 1120 galaxies in 20 arcmin
a major cycle over many samples takes 1.4 times as long with blocks of 2^22 as with one block for all of them, 1.9 times
with 2^21, and 6 times with 2^18."""

BYTES_PER_SAMPLE = 160
"""Memory for each sample of a block: the sample in the blocks of two accumulators, and its model."""

BYTES_PER_MOMENT = 8
"""Memory for each moment of a sample that is an average (``Samples.scatter``), in two blocks."""

BYTES_IN_FLIGHT = 96
"""Memory for each sample of a slab while it is gridded: its baseline as seen from a tile, the gridder's index, and the
visibilities of two slabs that wait to be added."""

SAMPLE_OVER_PIXEL = 3.0
"""Time that a sample takes over that of a pixel, when an image is degridded."""

BYTES_PER_PIXEL = 68
"""Memory for each pixel that is processed: the pixel, the gridder's oversampled plane, and two images that wait."""


@dataclass(frozen=True)
class Gridding:
    """Accuracy of the gridder, and its resources.

    Parameters
    ----------
    epsilon
        Relative error of the gridder.
    executor
        Executor for tiles and slabs of samples.
    memory
        Memory for the tiles and slabs that are processed at the same time [bytes]; there is always at least one.
    block
        Number of samples held in memory at a time.
    """

    epsilon: float = 1e-4
    executor: Executor = SERIAL
    memory: float = math.inf
    block: int = field(default_factory=lambda: BLOCK)

    @property
    def rows_block(self) -> int:
        """Number of samples of a range of rows that makes one block; they count whether they are used or not.

        Of an array with a dense core two thirds of the samples are on baselines that are used. The square degree of the
        paper, with 9.3 million samples, is one range.
        """
        return 3 * self.block // 2

    @classmethod
    def within(
        cls, resources: Resources, samples: int, epsilon: float = 1e-4, moments: int = 0
    ) -> Self:
        """Plan for a number of samples; what a block of them takes is no memory for images.

        ``moments`` is the number of moments that each sample carries; averages over cells have some.

        Raises
        ------
        InputError
            The memory does not hold a block of the samples.
        """
        gridding = cls(epsilon, resources.executor)
        each = BYTES_PER_SAMPLE + moments * BYTES_PER_MOMENT
        needed = min(samples, gridding.rows_block) * each
        if resources.memory < needed:
            raise InputError(
                f"--memory-gb {resources.memory / 1e9:.2g} (memory=): {math.ceil(needed / 1e7) / 100:g} GB or more are"
                f" needed for {samples} samples"
            )
        of_block = min(samples, gridding.block) * each
        return replace(gridding, memory=max(0.0, resources.memory - of_block))

    def executor_for(self, pixels: int, samples: int) -> Executor:
        """Return an executor whose workers' images, of ``pixels`` pixels along a side, fit into the memory together.

        ``samples`` is the number of samples that are imaged or predicted.
        """
        each = pixels**2 * BYTES_PER_PIXEL + min(samples, SLAB) * BYTES_IN_FLIGHT
        return self.executor.at_most(int(min(self.memory / each, self.executor.workers)))


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


def slabs(samples: int) -> list[slice]:
    """Divide samples into parts of at most ``SLAB``, as equal as can be."""
    count = max(1, -(-samples // SLAB))
    edges = [samples * k // count for k in range(count + 1)]
    return [slice(*pair) for pair in pairwise(edges)]


@dataclass(frozen=True)
class PredictedBand:
    """Samples of a band of baselines, and the tiles on which the sky is drawn for them."""

    samples: Samples
    tiles: Sequence[Tile]
    band: Band


def predict_samples(
    samples: Samples,
    tiles: Sequence[Tile],
    band: Band,
    sky: ModelledSky,
    gridding: Gridding,
) -> Complex[Array, " sample"]:
    """Predict the visibilities of the sky for samples of a band [Jy], by way of images on its tiles."""
    (model,) = predict_bands([PredictedBand(samples, tiles, band)], sky, gridding)
    return model


def predict_bands(
    bands: Sequence[PredictedBand],
    sky: ModelledSky,
    gridding: Gridding,
    on_share: Callable[[float], None] | None = None,
) -> list[Complex[Array, " _"]]:
    """Predict the visibilities of the sky for samples of several bands [Jy]; all tiles are in one round of tasks.

    ``on_share`` is called now and then with the share of the time that has passed since the last call, as estimated.
    """
    models = [np.zeros(len(each.samples), np.complex64) for each in bands]
    response = sky.response
    parts = [
        part
        for number in _longest_first(bands)
        for tile in _largest_first(bands[number].tiles)
        for part in _parts(number, _padded(tile, sky, bands[number].band), sky, bands[number].band)
    ]

    def draw(part: _Part, image: _Image) -> None:
        members = part.tile.members
        image.keep(
            lambda: render(
                sky.galaxies.select(members),
                part.flux,
                sky.half_width[members],
                part.tile,
                bands[part.number].band,
                sky.profile,
            )
        )

    def predict(part: _Part, image: _Image, rows: slice) -> _Predicted:
        samples, pixel = bands[part.number].samples, bands[part.number].band.pixel
        plane = TangentPlane.at(samples.uvw[rows], *part.tile.centre(pixel))
        vis = plane.visibilities(image.value(), pixel, gridding.epsilon)
        factor = response.source_factor(samples.select(rows), *part.seen_as)
        return part.number, rows, vis * factor, part.tile.size

    def tasks_of(part: _Part) -> tuple[Callable[[], None], list[Callable[[], _Predicted]]]:
        # Only the tasks know the image, so that it is released after the last of them.
        image = _Image()
        rows = slabs(len(bands[part.number].samples))
        return partial(draw, part, image), [partial(predict, part, image, each) for each in rows]

    tasks = one_ahead(map(tasks_of, parts))
    widest = max((part.tile.size for part in parts), default=1)
    most = max((len(each.samples) for each in bands), default=0)
    whole = sum(_cost(part.tile.size, len(bands[part.number].samples)) for part in parts)
    for predicted in gridding.executor_for(widest, most).map(_run, tasks):
        if predicted is not None:
            number, rows, vis, size = predicted
            models[number][rows] += vis
            if on_share is not None:
                each = slabs(len(bands[number].samples))
                on_share(_cost(size, len(bands[number].samples)) / (len(each) * whole))

    def finish(number: int) -> None:
        models[number] *= response.gain(bands[number].samples.frequency)

    for _ in gridding.executor.map(finish, range(len(bands))):
        pass
    return models


_Image: TypeAlias = Promise[Float[Array, "l m"]]
"""Image of a tile, which one task draws and others degrid."""

_Predicted: TypeAlias = tuple[int, slice, Complex[Array, " slab"], int]
"""Number of a band, some of its samples, what a tile adds to their visibilities [Jy], and the side of the tile."""


def _run(task: Callable[[], _Predicted | None]) -> _Predicted | None:
    return task()


def one_ahead(
    parts: Iterable[tuple[Callable[[], None], Sequence[Callable[[], Value]]]],
) -> Iterator[Callable[[], Value | None]]:
    """Yield the tasks of all parts, each of which has a first task that prepares its others.

    The first task comes before the others of the previous part, so that these run meanwhile.
    """
    ready: Sequence[Callable[[], Value]] = ()
    for prepare, others in parts:
        yield prepare
        yield from ready
        ready = others
    yield from ready


def _cost(size: int, samples: int) -> float:
    """Estimate the time in which samples are predicted from an image of this size, in that of a pixel."""
    return size**2 + SAMPLE_OVER_PIXEL * samples


def _largest_first(tiles: Sequence[Tile]) -> list[Tile]:
    """Order tiles of a band so that all workers end at about the same time."""
    return sorted(tiles, key=lambda tile: tile.size, reverse=True)


def _longest_first(bands: Sequence[PredictedBand]) -> list[int]:
    """Order bands by the time that a tile takes, so that all workers end at about the same time."""

    def cost(number: int) -> float:
        largest = max((tile.size for tile in bands[number].tiles), default=0)
        return _cost(largest, len(bands[number].samples))

    return sorted(range(len(bands)), key=cost, reverse=True)


@dataclass(frozen=True)
class _Part:
    """Fluxes of a tile's members [Jy], with the sample factors of a source at (l, m) of one spectral index.

    ``number`` is that of the tile's band.
    """

    number: int
    tile: Tile
    flux: Float[Array, " member"]
    seen_as: SeenAs


def _parts(number: int, tile: Tile, sky: ModelledSky, band: Band) -> list[_Part]:
    members = sky.galaxies.select(tile.members)
    shared = sky.response.shared_factors(members, band.shortest, band.longest)
    parts = []
    for source, coefficients in zip(shared.chosen.tolist(), shared.coefficients, strict=True):
        parts.append(_Part(number, tile, members.flux * coefficients, seen_as(members, source)))
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
    return Tile(tile.band, square_around(low, high, size), size, tile.members, tile.parent)
