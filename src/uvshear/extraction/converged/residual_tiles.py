"""Residual images on the tiles of all bands, and the facets that are cut out of the finest.

A task images a slab of samples on a tile, with one of its filters. A last task for each tile of the finest band adds up
the images of the tile and those of the coarser bands, and cuts out facets. All tasks are in one round, so that workers
do not wait for one another at the end of each band.
"""

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from itertools import chain
from typing import Final

from uvshear.execution import Promise, UsedValue
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.extraction.converged.tile_filters import TileFilters
from uvshear.extraction.converged.tile_sizes import work_of
from uvshear.imaging.bands import Band
from uvshear.imaging.interpolation import add_refined
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Tile
from uvshear.interferometer.samples import Samples
from uvshear.predict.gridded import Gridding, slabs
from uvshear.predict.response import Response
from uvshear.typing import Array, Complex, Float

UNCUT: Final = 2
"""Number of tiles that are imaged before the cutouts of the previous one are taken."""

Images = list[Float[Array, "l m"]]
"""Images of one tile, one for each of its filters."""


@dataclass(frozen=True)
class BandView:
    """Samples of a band, and the tiles on which they are imaged."""

    samples: Samples
    tiles: Sequence[Tile]
    filters: Sequence[TileFilters]
    band: Band


@dataclass(frozen=True)
class WeightedResiduals:
    """Residuals of bands, and how they are imaged.

    Parameters
    ----------
    views
        Bands from the coarsest to the finest that is used, out of which facets are cut.
    weighted
        Residual times weight times the common spectrum for each sample of each band [1/Jy].
    response
        Spectrum and attenuation of each source over the samples.
    epsilon
        Relative error of the gridder.
    """

    views: Sequence[BandView]
    weighted: Sequence[Complex[Array, " _"]]
    response: Response
    epsilon: float


def add_to_facets(
    residuals: WeightedResiduals,
    plan: MajorCyclePlan,
    facets: Sequence[Complex[Array, " _"]],
    gridding: Gridding,
) -> Iterator[float]:
    """Image the residuals and add the cutout of each source to its facet, while results are taken.

    Yields
    ------
    float
        After each image of a slab of samples, its estimated share of the time of all of them.
    """
    tiles = _tiles_of_bands(residuals)
    widest = max(each.tile.size for of_band in tiles for each in of_band)
    most = max(len(view.samples) for view in residuals.views)

    whole = sum(each.work for each in chain.from_iterable(tiles))

    def image(each: _ImagedTile, part: int) -> float:
        each.image(part)
        return each.work / (len(each) * whole)

    def cut(each: _ImagedTile) -> float:
        with each.used_images() as images:
            _cut(images, each.tile, each.filters, plan, facets)
        return 0.0

    tasks: list[Callable[[], float]] = []
    uncut = deque[_ImagedTile]()
    largest_first = sorted(tiles[-1], key=lambda each: each.tile.size, reverse=True)
    for each in chain(chain.from_iterable(tiles[:-1]), largest_first):
        tasks += [partial(image, each, part) for part in range(len(each))]
        if each.is_top:
            uncut.append(each)
        # The cutouts of a tile may have to wait for a coarser band; others are imaged meanwhile.
        if len(uncut) > UNCUT:
            tasks.append(partial(cut, uncut.popleft()))
    tasks += [partial(cut, each) for each in uncut]
    for share in gridding.executor_for(widest, most).map(_run, tasks):
        if share:
            yield share


def _run(task: Callable[[], float]) -> float:
    return task()


def _tiles_of_bands(residuals: WeightedResiduals) -> list[list["_ImagedTile"]]:
    tiles: list[list[_ImagedTile]] = []
    for number, view in enumerate(residuals.views):
        of_band = []
        for tile, filters in zip(view.tiles, view.filters, strict=True):
            parent = tiles[-1][tile.parent] if tile.parent >= 0 else None
            of_band.append(_ImagedTile(residuals, number, tile, filters, parent))
        tiles.append(of_band)
    return tiles


class _ImagedTile:
    """A tile of a band, which is imaged in parts: each of its filters with each slab of samples.

    Parameters
    ----------
    residuals
        Residuals of all bands.
    number
        Number of the tile's band among them.
    tile, filters
        The tile, and its filters.
    parent
        The tile of the next coarser band that covers this one; None in the coarsest.
    """

    def __init__(
        self,
        residuals: WeightedResiduals,
        number: int,
        tile: Tile,
        filters: TileFilters,
        parent: "_ImagedTile | None",
    ) -> None:
        self.view, self.tile, self.filters = residuals.views[number], tile, filters
        self.is_top = number == len(residuals.views) - 1
        self._residuals, self._weighted = residuals, residuals.weighted[number]
        self._rows = slabs(len(self.view.samples))
        self._parts = [Promise[Float[Array, "l m"]]() for _ in range(len(self))]
        # They are completed when they are first needed, by which time the parts of coarser bands are mostly done.
        self.images: UsedValue[Images] = UsedValue()
        self._parent = parent
        if self.is_top:
            self.images.announce_use()
        if parent is not None:
            parent.images.announce_use()

    def __len__(self) -> int:
        return len(self.filters.seen_as) * len(self._rows)

    @property
    def work(self) -> float:
        """Estimated cost of its images, on one core [ns]."""
        return len(self.filters.seen_as) * work_of(len(self.view.samples), self.tile)

    def used_images(self) -> AbstractContextManager[Images]:
        """Return a context that yields the complete images for one use."""
        return self.images.used(self._complete)

    def image(self, part: int) -> None:
        """Image one part, and add it to the previous slab of its filter."""
        self._parts[part].keep(lambda: self._summed(part))

    def _summed(self, part: int) -> Float[Array, "l m"]:
        image = self._image(part)
        if part % len(self._rows) == 0:
            return image
        total = self._parts[part - 1].value()
        total += image
        return total

    def _image(self, part: int) -> Float[Array, "l m"]:
        of_filter, slab = divmod(part, len(self._rows))
        rows, pixel = self._rows[slab], self.view.band.pixel
        samples = self.view.samples.select(rows)
        matched = self._residuals.response.matched_filter(samples, *self.filters.seen_as[of_filter])
        plane = TangentPlane.at(samples.uvw, *self.tile.centre(pixel))
        filtered = self._weighted[rows] * matched
        return plane.image(filtered, self.tile.size, pixel, self._residuals.epsilon)

    def _complete(self) -> Images:
        """Return the image of each filter, with the images of the coarser bands, interpolated."""
        count = len(self._rows)
        images = [part.value() for part in self._parts[count - 1 :: count]]
        self._parts.clear()
        if self._parent is not None:
            self._add_coarser(images, self._parent)
        return images

    def _add_coarser(self, images: Images, parent: "_ImagedTile") -> None:
        (i, j), (k, l) = self.tile.origin, parent.tile.origin
        with parent.used_images() as coarser:
            for source, image in zip(self.filters.chosen.tolist(), images, strict=True):
                add_refined(image, parent.filters.mixed(coarser, source), (i - 2 * k, j - 2 * l))


def _cut(
    images: Images,
    tile: Tile,
    filters: TileFilters,
    plan: MajorCyclePlan,
    facets: Sequence[Complex[Array, " _"]],
) -> None:
    """Add the cutouts of a tile's members to their facets."""
    for source in tile.members.tolist():
        cutout, facet = plan.cutouts[source], facets[source]
        size, place = cutout.size // 2**plan.top, plan.place[source] // 2**plan.top
        i, j = place - tile.origin - size // 2
        square = filters.mixed([image[i : i + size, j : j + size] for image in images], source)
        if plan.top == 0:
            facet += cutout.transform(square)
        else:
            cutout.add_coarse(square, 1.0, facet)
