"""One major cycle: all models are subtracted from the visibilities, and the residual is gathered as facets.

In each band of baselines the models are drawn on tiles and degridded; the residual is imaged on the same tiles, once
for each of their filters (``tile_filters``). From the coarsest band on, images are interpolated and added to those of
the next finer band, and facets are cut out of the finest. Images are discarded after each block of samples; only the
facets are added up.
"""

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from uvshear.execution import Executor
from uvshear.execution.shared_memory import shared_zeros
from uvshear.extraction.converged.beams import BeamAccumulator, BeamPlan, Beams
from uvshear.extraction.converged.plan import MajorCyclePlan
from uvshear.extraction.converged.residual_tiles import (
    BandView,
    WeightedResiduals,
    add_to_facets,
)
from uvshear.extraction.converged.tile_filters import filters_of_plan
from uvshear.imaging.uv_order import uv_order
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.held_observation import blocks_of
from uvshear.interferometer.samples import Samples
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.blocks import BlockAccumulator
from uvshear.predict.gridded import Gridding, ModelledSky, PredictedBand, predict_bands
from uvshear.typing import Array, Complex, Int

_AT_A_TIME = 2**16
"""Number of samples in a task that assigns samples to bands."""

OnSamples = Callable[[float], None]
"""Function that is called with the number of samples that have been processed, in parts of samples."""

Facets = tuple[Complex[Array, " _"], ...]
"""Correlation of the residual with a point source at each source, in the cells of its facet [1/Jy]."""


def shared_facets(lengths: Sequence[int]) -> Facets:
    """Return facets of zeros with these numbers of cells, in memory that the workers of a crew share."""
    edges = np.cumsum([0, *lengths])
    everything = shared_zeros((int(edges[-1]),), np.complex64)
    return tuple(np.split(everything, edges[1:-1])) if lengths else ()


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
        Facet of each source with all models subtracted, including its own; its centre is ``plan.place``.
    """

    plan: MajorCyclePlan
    beams: Beams
    residuals: Facets


@dataclass(frozen=True)
class CycleSums:
    """Sums over some of the visibilities: facets, and the beams in the first cycle."""

    facets: Facets
    beams: Beams | None

    def __reduce__(self) -> tuple[Any, ...]:
        """Send all facets as one array."""
        lengths = [len(facet) for facet in self.facets]
        everything = np.concatenate(self.facets) if lengths else np.zeros(0, np.complex64)
        return CycleSums.from_joined, (everything, lengths, self.beams)

    @classmethod
    def from_joined(
        cls, everything: Complex[Array, " cell"], lengths: Sequence[int], beams: Beams | None
    ) -> Self:
        """Divide an array into facets with these numbers of cells."""
        edges = np.cumsum(lengths)[:-1]
        return cls(tuple(np.split(everything, edges)) if lengths else (), beams)

    def add(self, later: Self) -> Self:
        """Add sums over later visibilities."""
        for facet, more in zip(self.facets, later.facets, strict=True):
            np.add(facet, more, out=facet)
        if self.beams is not None and later.beams is not None:
            self.beams.add(later.beams)
        return self


@dataclass(frozen=True)
class CyclePass:
    """What a pass over the visibilities gathers; in another process it reports no work.

    Parameters
    ----------
    plan
        Bands, tiles and cutouts.
    sky
        The models to be subtracted.
    gridding
        Accuracy and resources.
    beam_plan
        Beams to be gathered; None if they are known.
    on_samples
        Function called now and then with the number of samples processed since the last call.
    share_of_beams
        Share of the beams in the work, if they are gathered.
    """

    plan: MajorCyclePlan
    sky: ModelledSky
    gridding: Gridding
    beam_plan: BeamPlan | None = None
    on_samples: OnSamples | None = None
    share_of_beams: float = 0.5

    def __getstate__(self) -> dict[str, object]:
        """Leave out the function that is called in this process."""
        return {**self.__dict__, "on_samples": None}

    def over(self, observation: Observation) -> CycleSums:
        """Gather from all visibilities.

        Blocks of an observation in files are ranges of rows. The workers of a cluster read, subtract and image them;
        otherwise they follow one another. Blocks of other observations are filled with samples as they come.
        """
        gridding = self.gridding
        blocks = blocks_of(observation, gridding.rows_block)
        if blocks is None or len(blocks) == 1:
            return self.sums(observation)
        # A range of rows is one block, even where it is a little longer than others.
        in_one = replace(self, gridding=replace(gridding, block=sys.maxsize))
        return gridding.executor.sum_partitions(CyclePass.sums, CycleSums.add, in_one, blocks)

    def sums(self, observation: Observation) -> CycleSums:
        """Gather in this process."""
        plan, sky, gridding = self.plan, self.sky, self.gridding
        if self.beam_plan is None:
            residuals = ResidualAccumulator(plan, sky, gridding, self.on_samples)
            (facets,) = accumulate(observation, [residuals])
            return CycleSums(facets, None)
        of_beams, of_residuals = (
            self._counted(self.share_of_beams),
            self._counted(1 - self.share_of_beams),
        )
        residuals = ResidualAccumulator(plan, sky, gridding, of_residuals)
        gathered = BeamAccumulator(self.beam_plan, sky.response, gridding, of_beams)
        beams, facets = accumulate(observation, [gathered, residuals])
        return CycleSums(facets, beams)

    def _counted(self, part: float) -> OnSamples | None:
        """Return a function that reports this part of the samples."""
        tell = self.on_samples
        return tell and (lambda samples: tell(part * samples))


def first_major_cycle(
    observation: Observation,
    plan: MajorCyclePlan,
    beam_plan: BeamPlan,
    sky: ModelledSky,
    gridding: Gridding,
    on_samples: OnSamples | None = None,
    share_of_beams: float = 0.5,
) -> MajorCycle:
    """Read the visibilities once, for the beams and for the residual facets.

    ``share_of_beams`` is that part of the work that makes the beams.
    """
    gathering = CyclePass(plan, sky, gridding, beam_plan, on_samples, share_of_beams)
    sums = gathering.over(observation)
    assert sums.beams is not None
    return MajorCycle(plan, sums.beams, sums.facets)


def next_major_cycle(
    observation: Observation,
    plan: MajorCyclePlan,
    beams: Beams,
    sky: ModelledSky,
    gridding: Gridding,
    on_samples: OnSamples | None = None,
) -> MajorCycle:
    """Read the visibilities once, for the residual facets; the beams are known."""
    sums = CyclePass(plan, sky, gridding, None, on_samples).over(observation)
    return MajorCycle(plan, beams, sums.facets)


def gather_residuals(
    observation: Observation,
    plan: MajorCyclePlan,
    sky: ModelledSky,
    gridding: Gridding,
    on_samples: OnSamples | None = None,
) -> Facets:
    """Return the facet of each source with all models subtracted, centred on the directions ``plan.centres``."""
    (facets,) = accumulate(observation, [ResidualAccumulator(plan, sky, gridding, on_samples)])
    for facet, cutout, offset in zip(facets, plan.cutouts, plan.offset, strict=True):
        cutout.recentre(facet, tuple(offset))
    return facets


class ResidualAccumulator(BlockAccumulator[Facets]):
    """Facets of all sources, with all models subtracted; the centre of each is its place on the pixels of the plan.

    Parameters
    ----------
    plan
        Bands, tiles and cutouts.
    sky
        The models to be subtracted.
    gridding
        Accuracy and resources.
    on_samples
        Function called now and then with the number of samples processed since the last call.
    """

    def __init__(
        self,
        plan: MajorCyclePlan,
        sky: ModelledSky,
        gridding: Gridding,
        on_samples: OnSamples | None = None,
    ) -> None:
        super().__init__(plan.shortest, plan.longest, gridding)
        self._plan, self._sky, self._gridding = plan, sky, gridding
        self._on_samples = on_samples
        self._filters = filters_of_plan(plan, sky.galaxies, sky.response)
        self._facets = shared_facets([len(cutout.multiplicity) for cutout in plan.cutouts])

    def add_sums(self, later: Self) -> None:
        """Add the facets of later visibilities."""
        for facet, more in zip(self._facets, later._facets, strict=True):
            np.add(facet, more, out=facet)

    def total(self) -> Facets:
        """Return the facets, centred on ``plan.place``."""
        return self._facets

    def add_block(self, samples: Samples) -> None:
        """Subtract the models, image the residual and cut out the facets, from the coarsest band to the finest."""
        plan, sky, gridding = self._plan, self._sky, self._gridding
        count = len(samples)
        bands = range(len(plan.bands) - 1, plan.top - 1, -1)
        views = [
            BandView(part, plan.tiles[b], self._filters[b], plan.bands[b])
            for b, part in zip(bands, _parts(samples, plan, bands, gridding.executor), strict=True)
        ]

        del samples  # those of the bands are copies

        def tell(share: float) -> None:
            if self._on_samples is not None:
                self._on_samples(share * count / 2)

        residuals = _weighted_residuals(views, sky, gridding, tell)
        for share in add_to_facets(residuals, plan, self._facets, gridding):
            tell(share)


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
    views: Sequence[BandView],
    sky: ModelledSky,
    gridding: Gridding,
    on_share: Callable[[float], None],
) -> WeightedResiduals:
    """Subtract the models, and multiply by the weights and the common spectrum.

    The common spectrum is the part of the matched filter that all sources share.
    """
    bands = [PredictedBand(view.samples, view.tiles, view.band) for view in views]
    models = predict_bands(bands, sky, gridding, on_share)

    def weighted(seen: tuple[BandView, Complex[Array, " _"]]) -> Complex[Array, " _"]:
        samples, model = seen[0].samples, seen[1]
        return (samples.stokes_i - model) * (samples.weights * sky.response.gain(samples.frequency))

    found = list(gridding.executor.map(weighted, zip(views, models, strict=True)))
    return WeightedResiduals(views, found, sky.response, gridding.epsilon)
