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
from uvshear.imaging.interpolation import refined
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Tile
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding, ModelledSky, predict_samples, slabs
from uvshear.predict.response import Response, SeenAs
from uvshear.typing import Array, Complex, Float

OnWork = Callable[[float], None]
"""Function that is called with the work that has been done [nanoseconds, roughly]."""

Images = list[Array]
"""Images of one tile, one for each of its filters."""

Facets = tuple[Complex[Array, " _"], ...]
"""Data on the cells of each source's facet."""


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
    """Gather the facet of each source with all models subtracted, centred where the plan says."""
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
        Function called after each tile with the work that it took.
    """

    def __init__(
        self,
        plan: MajorCyclePlan,
        sky: ModelledSky,
        gridding: Gridding,
        on_work: OnWork | None = None,
    ) -> None:
        super().__init__(plan.shortest, plan.longest, gridding.block)
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
        return tuple(
            facet * cutout.recentring(tuple(offset))
            for facet, cutout, offset in zip(self._facets, plan.cutouts, plan.offset, strict=True)
        )

    def add_block(self, samples: Samples) -> None:
        """Subtract the models, image the residual and cut out the facets, band by band."""
        plan, sky, gridding = self._plan, self._sky, self._gridding
        number = plan.band_of(samples.uvw)
        coarser: list[Images] = []
        for b in range(len(plan.bands) - 1, plan.top - 1, -1):
            band, tiles, filters = plan.bands[b], plan.tiles[b], self._filters[b]
            part = samples.select(np.flatnonzero(number == b))
            weighted = _weighted_residual(part, tiles, band, sky, gridding)
            new = _images(part, weighted, tiles, filters, band, sky.response, gridding)
            kept = []
            for tile, matched, images in zip(tiles, filters, new, strict=True):
                if tile.parent >= 0:
                    above = plan.tiles[b + 1][tile.parent], self._filters[b + 1][tile.parent]
                    _add_coarser(images, tile, matched, coarser[tile.parent], *above)
                if b == plan.top:
                    _cut(images, tile, matched, plan, self._facets, gridding.executor)
                else:
                    kept.append(images)
                if self._on_work is not None:
                    self._on_work(work_of(len(part), tile))
            coarser = kept


def _weighted_residual(
    samples: Samples,
    tiles: Sequence[Tile],
    band: Band,
    sky: ModelledSky,
    gridding: Gridding,
) -> Complex[Array, " sample"]:
    """Weight times the residual of each sample, with the common power law as matched filter."""
    model = predict_samples(samples, tiles, band, sky, gridding)
    gain = sky.response.gain(samples.frequency)
    return (samples.stokes_i - model) * (samples.weights * gain)


def _images(
    samples: Samples,
    weighted: Complex[Array, " sample"],
    tiles: Sequence[Tile],
    filters: Sequence[TileFilters],
    band: Band,
    response: Response,
    gridding: Gridding,
) -> Iterator[Images]:
    """Image each tile in turn, with each of its filters."""

    def image(task: tuple[Tile, SeenAs, slice]) -> Float[Array, "l m"]:
        tile, seen_as, rows = task
        filtered = weighted[rows] * response.matched_filter(samples.select(rows), *seen_as)
        plane = TangentPlane.at(samples.uvw[rows], *tile.centre(band.pixel))
        return plane.image(filtered, tile.size, band.pixel, gridding.epsilon)

    parts_of_rows = slabs(len(samples))
    tasks = (
        (tile, seen_as, rows)
        for tile, matched in zip(tiles, filters, strict=True)
        for seen_as in matched.seen_as
        for rows in parts_of_rows
    )
    widest = max(tile.size for tile in tiles)
    parts = gridding.executor_for(widest, len(samples)).map(image, tasks)
    for matched in filters:
        images = []
        for _ in matched.seen_as:
            total = next(parts)
            for _ in parts_of_rows[1:]:
                total += next(parts)
            images.append(total)
        yield images


def _add_coarser(
    images: Images,
    tile: Tile,
    matched: TileFilters,
    coarser: Images,
    above: Tile,
    matched_above: TileFilters,
) -> None:
    """Add the images of the coarser tile above, mixed for each filter of the finer one."""
    (i, j), (k, l) = tile.origin, above.origin
    shift = i - 2 * k, j - 2 * l
    for source, image in zip(matched.chosen.tolist(), images, strict=True):
        mixed = matched_above.mixed(coarser, source)
        np.add(image, refined(mixed, shift, tile.size), out=image)


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

    for _ in executor.map(add, tile.members.tolist()):
        pass
