"""One major cycle: all models are subtracted from the visibilities, and the residual is gathered as facets.

In each band of baselines the models are drawn on tiles and degridded; the residual is imaged on the same tiles, once
for each of their filters (``tile_filters``). From the coarsest band on, images are interpolated and added to those of
the next finer band, and facets are cut out of the finest. Images are discarded after each block of samples; only the
facets are added up.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.execution import Executor
from uvshear.extraction.converged.beams import BeamAccumulator, BeamPlan, Beams
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.extraction.converged.tile_filters import TileFilters, filters_of_plan
from uvshear.extraction.converged.tile_sizes import work_of
from uvshear.imaging.bands import Band
from uvshear.imaging.interpolation import add_refined
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Tile
from uvshear.imaging.uv_order import uv_order
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding, ModelledSky, PredictedBand, predict_bands, slabs
from uvshear.predict.response import Response, SeenAs
from uvshear.typing import Array, Complex, Float, Int

_AT_A_TIME = 2**19
"""Number of samples in a task that assigns samples to bands."""

_BATCH = 32
"""Number of sources whose facets a worker takes at a time."""

OnWork = Callable[[float], None]
"""Function that is called with the estimated cost of the work that has been done, on one core [ns]
(``tile_sizes.work_of``)."""

Images = list[Array]
"""Images of one tile, one for each of its filters."""

Facets = tuple[Complex[Array, " _"], ...]
"""Correlation of the residual with a point source at each source, in the cells of its facet [1/Jy]."""


@dataclass(frozen=True)
class MajorCycle:
    """Results of a major cycle, with which the minor cycle works.

    Parameters
    ----------
    plan
        Bands, tiles and cutouts of the cycle.
    beams
        Dirty beams over the field.
    residuals
        Facet of each source with all models subtracted, including its own.
    """

    plan: MajorCyclePlan
    beams: Beams
    residuals: Facets


def first_major_cycle(
    observation: Observation,
    plan: MajorCyclePlan,
    beam_plan: BeamPlan,
    sky: ModelledSky,
    gridding: Gridding,
    on_work: OnWork | None = None,
) -> MajorCycle:
    """Read the visibilities once, for the beams and for the residual facets."""
    beams, residuals = accumulate(
        observation,
        [
            BeamAccumulator(beam_plan, sky.response, gridding, on_work),
            ResidualAccumulator(plan, sky, gridding, on_work),
        ],
    )
    return MajorCycle(plan, beams, residuals)


def next_major_cycle(
    observation: Observation,
    plan: MajorCyclePlan,
    beams: Beams,
    sky: ModelledSky,
    gridding: Gridding,
    on_work: OnWork | None = None,
) -> MajorCycle:
    """Read the visibilities once, for the residual facets; the beams are known."""
    residuals = gather_residuals(observation, plan, sky, gridding, on_work)
    return MajorCycle(plan, beams, residuals)


def gather_residuals(
    observation: Observation,
    plan: MajorCyclePlan,
    sky: ModelledSky,
    gridding: Gridding,
    on_work: OnWork | None = None,
) -> Facets:
    """Return the facet of each source with all models subtracted, centred on the directions ``plan.centres``."""
    (facets,) = accumulate(observation, [ResidualAccumulator(plan, sky, gridding, on_work)])
    return facets


class ResidualAccumulator(BlockAccumulator[Facets]):
    """Facets of all sources, with all models subtracted.

    Parameters
    ----------
    plan
        Bands, tiles and cutouts.
    sky
        The models to be subtracted.
    gridding
        Accuracy and resources.
    on_work
        Function called after each tile with the estimated cost of imaging it once [ns].
    """

    def __init__(
        self,
        plan: MajorCyclePlan,
        sky: ModelledSky,
        gridding: Gridding,
        on_work: OnWork | None = None,
    ) -> None:
        super().__init__(plan.shortest, plan.longest, gridding)
        self._plan, self._sky, self._gridding, self._on_work = plan, sky, gridding, on_work
        self._filters = filters_of_plan(plan, sky.galaxies, sky.response)
        self._facets = [np.zeros(len(cutout.multiplicity), np.complex64) for cutout in plan.cutouts]

    def add_sums(self, later: Self) -> None:
        """Add the facets of later visibilities."""
        for facet, more in zip(self._facets, later._facets, strict=True):
            np.add(facet, more, out=facet)

    def total(self) -> Facets:
        """Return the facets, centred on their sources."""
        plan = self._plan

        def centred(source: int) -> Complex[Array, " _"]:
            facet = self._facets[source].copy()
            plan.cutouts[source].recentre(facet, tuple(plan.offset[source]))
            return facet

        sources = range(len(self._facets))
        return tuple(self._gridding.executor.map_in_batches(centred, sources, _BATCH))

    def add_block(self, samples: Samples) -> None:
        """Subtract the models, image the residual and cut out the facets, from the coarsest band to the finest."""
        plan, sky, gridding = self._plan, self._sky, self._gridding
        bands = range(len(plan.bands) - 1, plan.top - 1, -1)
        views = [
            _BandView(part, plan.tiles[b], self._filters[b], plan.bands[b])
            for b, part in zip(bands, _parts(samples, plan, bands, gridding.executor), strict=True)
        ]
        weighted = _weighted_residuals(views, sky, gridding)
        images_of_bands = _images(views, weighted, sky.response, gridding)
        coarser: list[Images] = []
        for b, view in zip(bands, views, strict=True):
            kept = []
            for tile, matched in zip(view.tiles, view.filters, strict=True):
                images = next(images_of_bands)
                if tile.parent >= 0:
                    parent = plan.tiles[b + 1][tile.parent], self._filters[b + 1][tile.parent]
                    _add_coarser(images, tile, matched, coarser[tile.parent], *parent)
                if b == plan.top:
                    _cut(images, tile, matched, plan, self._facets, gridding.executor)
                else:
                    kept.append(images)
                if self._on_work is not None:
                    self._on_work(work_of(len(view.samples), tile))
            coarser = kept


@dataclass(frozen=True)
class _BandView:
    """Samples of a band, and the tiles on which they are imaged."""

    samples: Samples
    tiles: Sequence[Tile]
    filters: Sequence[TileFilters]
    band: Band


def _parts(
    samples: Samples, plan: MajorCyclePlan, bands: Sequence[int], executor: Executor
) -> Iterator[Samples]:
    """Yield the samples of each band, in an order in which the gridder is fast."""
    edges = range(0, len(samples), _AT_A_TIME)
    numbers = executor.map(lambda k: plan.band_of(samples.uvw[k : k + _AT_A_TIME]), edges)
    number = np.concatenate(list(numbers))

    def order(band: int) -> Int[Array, " chosen"]:
        chosen = np.flatnonzero(number == band)
        return chosen[uv_order(samples.uvw[chosen])]

    for chosen in executor.map(order, bands):
        yield samples.taken(chosen, executor)


def _weighted_residuals(
    views: Sequence[_BandView], sky: ModelledSky, gridding: Gridding
) -> list[Complex[Array, " _"]]:
    """Return residual times weight times the common spectrum for each sample of each band [1/Jy].

    This is the matched filter that all sources share.
    """
    models = predict_bands(
        [PredictedBand(view.samples, view.tiles, view.band) for view in views], sky, gridding
    )

    def weighted(seen: tuple[_BandView, Complex[Array, " _"]]) -> Complex[Array, " _"]:
        samples, model = seen[0].samples, seen[1]
        return (samples.stokes_i - model) * (samples.weights * sky.response.gain(samples.frequency))

    return list(gridding.executor.map(weighted, zip(views, models, strict=True)))


def _images(
    views: Sequence[_BandView],
    weighted: Sequence[Complex[Array, " _"]],
    response: Response,
    gridding: Gridding,
) -> Iterator[Images]:
    """Yield the dirty images of each tile, one for each of its filters, in the order of bands and tiles.

    Workers image tiles of different bands at the same time.
    """

    def image(task: tuple[int, Tile, SeenAs, slice]) -> Float[Array, "l m"]:
        number, tile, seen_as, rows = task
        view = views[number]
        part, pixel = view.samples.select(rows), view.band.pixel
        filtered = weighted[number][rows] * response.matched_filter(part, *seen_as)
        plane = TangentPlane.at(view.samples.uvw[rows], *tile.centre(pixel))
        return plane.image(filtered, tile.size, pixel, gridding.epsilon)

    tasks = (
        (number, tile, seen_as, rows)
        for number, view in enumerate(views)
        for tile, matched in zip(view.tiles, view.filters, strict=True)
        for seen_as in matched.seen_as
        for rows in slabs(len(view.samples))
    )
    widest = max(tile.size for view in views for tile in view.tiles)
    most = max(len(view.samples) for view in views)
    parts = gridding.executor_for(widest, most).map(image, tasks)
    for view in views:
        count = len(slabs(len(view.samples)))
        for matched in view.filters:
            images = []
            for _ in matched.seen_as:
                total = next(parts)
                for _ in range(count - 1):
                    total += next(parts)
                images.append(total)
            yield images


def _add_coarser(
    images: Images,
    tile: Tile,
    matched: TileFilters,
    coarser: Images,
    parent: Tile,
    matched_parent: TileFilters,
) -> None:
    """Add the images of the parent tile in the next coarser band, interpolated, and combined for each filter."""
    (i, j), (k, l) = tile.origin, parent.origin
    shift = i - 2 * k, j - 2 * l
    for source, image in zip(matched.chosen.tolist(), images, strict=True):
        mixed = matched_parent.mixed(coarser, source)
        add_refined(image, mixed, shift)


def _cut(
    images: Images,
    tile: Tile,
    matched: TileFilters,
    plan: MajorCyclePlan,
    facets: Sequence[Complex[Array, " _"]],
    executor: Executor,
) -> None:
    """Add the cutouts of a tile's members to their facets."""

    def add(source: int) -> None:
        cutout, facet = plan.cutouts[source], facets[source]
        size, place = cutout.size // 2**plan.top, plan.place[source] // 2**plan.top
        i, j = place - tile.origin - size // 2
        square = matched.mixed([image[i : i + size, j : j + size] for image in images], source)
        if plan.top == 0:
            facet += cutout.transform(square)
        else:
            cutout.add_coarse(square, 1.0, facet)

    for _ in executor.map_in_batches(add, tile.members.tolist(), _BATCH):
        pass
