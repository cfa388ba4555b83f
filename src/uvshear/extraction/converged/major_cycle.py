"""One major cycle: all models are subtracted from the visibilities, and the residual is gathered as facets.

In each band of baselines the models are drawn on tiles and degridded; the residual is imaged on the same tiles. From
the coarsest band on, images are interpolated and added to those of the next finer band, and facets are cut out of the
finest. Images are discarded after each block of samples; only the facets are added up.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.execution import Executor
from uvshear.extraction.converged.beams import BeamAccumulator, BeamPlan, Beams
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.imaging.bands import Band
from uvshear.imaging.interpolation import refined
from uvshear.imaging.tangent import TangentPlane
from uvshear.imaging.tiles import Tile
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding, ModelledSky, predict_samples, slabs
from uvshear.predict.response import Response
from uvshear.typing import Array, Complex, Float

OnWork = Callable[[float], None]
"""Function that is called with the work that has been done [nanoseconds, roughly]."""

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
        coarser: list[Float[Array, "l m"]] = []
        for b in range(len(plan.bands) - 1, plan.top - 1, -1):
            band, tiles = plan.bands[b], plan.tiles[b]
            part = samples.select(np.flatnonzero(number == b))
            weighted = _weighted_residual(part, tiles, band, sky, gridding)
            images = []
            for tile, image in zip(
                tiles, _images(part, weighted, tiles, band, sky.response, gridding), strict=True
            ):
                if tile.parent >= 0:
                    above = plan.tiles[b + 1][tile.parent]
                    (i, j), (k, l) = tile.origin, above.origin
                    shift = i - 2 * k, j - 2 * l
                    np.add(image, refined(coarser[tile.parent], shift, tile.size), out=image)
                if b == plan.top:
                    _cut(image, tile, plan, self._facets, gridding.executor)
                else:
                    images.append(image)
                if self._on_work is not None:
                    self._on_work(work_of(len(part), tile))
            coarser = images


def work_of(samples: int, tile: Tile) -> float:
    """Estimate the cost of a tile [nanoseconds]."""
    return 700 * samples + 150 * tile.size**2


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
    band: Band,
    response: Response,
    gridding: Gridding,
) -> Iterator[Float[Array, "l m"]]:
    """Image each tile in turn, with the response at its centre as matched filter."""

    def image(task: tuple[Tile, slice]) -> Float[Array, "l m"]:
        tile, rows = task
        centre = tile.centre(band.pixel)
        filtered = weighted[rows] * response.matched_filter(samples.select(rows), *centre)
        plane = TangentPlane.at(samples.uvw[rows], *centre)
        return plane.image(filtered, tile.size, band.pixel, gridding.epsilon)

    parts_of_rows = slabs(len(samples))
    parts = gridding.executor.map(image, ((tile, rows) for tile in tiles for rows in parts_of_rows))
    for _ in tiles:
        total = next(parts)
        for _ in parts_of_rows[1:]:
            total += next(parts)
        yield total


def _cut(
    image: Float[Array, "l m"],
    tile: Tile,
    plan: MajorCyclePlan,
    facets: Sequence[Complex[Array, " _"]],
    executor: Executor,
) -> None:
    """Add the cutouts of a tile's members to their facets."""

    def add(source: int) -> None:
        cutout, facet = plan.cutouts[source], facets[source]
        size, place = cutout.size // 2**plan.top, plan.place[source] // 2**plan.top
        i, j = place - tile.origin - size // 2
        square = image[i : i + size, j : j + size]
        if plan.top == 0:
            facet += cutout.transform(square)
        else:
            cutout.add_coarse(square, 1.0, facet)

    for _ in executor.map(add, tile.members.tolist()):
        pass
