"""Passes over the sources of a field in decreasing flux."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from uvshear.execution import single_threaded_libraries
from uvshear.extraction.extraction import Setting
from uvshear.extraction.field import Field
from uvshear.extraction.paper.facet_gathering import FacetAccumulator
from uvshear.extraction.paper.facets import FacetMethod, Target
from uvshear.extraction.paper.paper_sky import PaperSky
from uvshear.extraction.paper.paper_state import PaperState
from uvshear.extraction.paper.residual import Residual, SubtractedSky
from uvshear.extraction.schedule import fitting_levels
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Observation
from uvshear.shapes.measurement import GalaxyFit, ShapeMeasurement
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import fit_galaxy, measure_shape
from uvshear.shapes.significance import with_significance
from uvshear.typing import Array, Int

FACETS_AT_A_TIME = 64
"""Largest number of facets that are gathered in one major cycle."""

Batch = Int[Array, "_"]
"""Sources that share a major cycle, as indices of the catalogue."""

Fitted = TypeVar("Fitted")


def batches(field: Field, sources: Int[Array, " chosen"], separation: float) -> list[Batch]:
    """Order sources by flux where they are closer than ``separation`` [rad]; each batch is a major cycle."""
    lm = np.column_stack([field.l, field.m])[sources]
    levels = fitting_levels(lm, field.sky.flux[sources], separation)
    return [
        sources[level[first : first + FACETS_AT_A_TIME]]
        for level in levels
        for first in range(0, len(level), FACETS_AT_A_TIME)
    ]


@dataclass(frozen=True)
class SequentialPass:
    """Fits batches of sources one after the other, each with the sky that results from the fits before it.

    Parameters
    ----------
    observation
        The visibilities, which are read once for each batch.
    field
        The sources.
    setting
        Assumptions about the sources, and the resources.
    facet
        Method of making facets.
    on_rows
        Function called with the number of rows of each chunk that was read.
    """

    observation: Observation
    field: Field
    setting: Setting
    facet: FacetMethod
    on_rows: Callable[[int], None]

    @cached_property
    def subtracted(self) -> SubtractedSky:
        """Visibilities of the sources, which the batches have in common."""
        first = self.field.sky.select(self.field.modelled)
        return SubtractedSky(first, self.setting.model.profile, self.setting.resources)

    def improve(self, reached: PaperState, batch: Batch) -> PaperState:
        """Fit the sources of a batch, and improve the sky with them."""
        sky, fits = self._fit_batch(reached.sky, batch, self._fit)
        return reached.with_sky(sky.with_fits(self.field, batch.tolist(), fits))

    def measure(self, reached: PaperState, batch: Batch) -> PaperState:
        """Fit the sources of a batch and sample their posteriors, and improve the sky with them."""
        sky, found = self._measured(reached.sky, batch)
        return replace(reached.with_sky(sky), measurements={**reached.measurements, **found})

    def measure_again(self, reached: PaperState, batch: Batch) -> PaperState:
        """Measure the sources of a batch a second time, after the first measurement of all others."""
        sky, found = self._measured(reached.sky, batch)
        return replace(reached.with_sky(sky), measured_again={**reached.measured_again, **found})

    def _measured(
        self, sky: PaperSky, batch: Batch
    ) -> tuple[PaperSky, Mapping[int, ShapeMeasurement]]:
        sources = batch.tolist()
        sky, shapes = self._fit_batch(sky, batch, self._measure)
        sky = sky.with_fits(self.field, sources, [shape.best for shape in shapes])
        return sky, dict(zip(sources, shapes, strict=True))

    def _fit_batch(
        self,
        sky: PaperSky,
        batch: Batch,
        fit: Callable[[int, Facet, GalaxyFit | None], Fitted],
    ) -> tuple[PaperSky, Sequence[Fitted]]:
        """Gather the facets of a batch in one major cycle, and fit its sources in parallel."""
        sources = batch.tolist()
        facets = self._gather(sky, batch)
        tasks = zip(sources, facets, strict=True)
        # Threads of the linear algebra would compete with those of the fits, and change the last bits.
        with single_threaded_libraries():
            fitted = list(
                self.setting.resources.executor.map(
                    lambda task: fit(*task, sky.fits.get(task[0])), tasks
                )
            )
        return sky.with_facets(sources, facets), fitted

    def _gather(self, sky: PaperSky, batch: Batch) -> list[Facet]:
        builders = [
            self.facet.open(
                Target.from_field(self.field, source, sky.fits.get(source)),
                self.setting.model.profile,
                sky.power.get(source),
            )
            for source in batch.tolist()
        ]
        models = [sky.sky.select(np.array([source])) for source in batch]
        gathering = FacetAccumulator(
            builders, models, self.setting.resources.executor, self.on_rows
        )
        residual = Residual(self.observation, sky.sky.select(self.field.modelled), self.subtracted)
        (facets,) = accumulate(residual, [gathering])
        return facets

    def _fit(self, source: int, facet: Facet, start: GalaxyFit | None) -> GalaxyFit | None:
        return fit_galaxy(facet, self._prior(source), self.setting.model.profile, start)

    def _measure(self, source: int, facet: Facet, start: GalaxyFit | None) -> ShapeMeasurement:
        prior, profile = self._prior(source), self.setting.model.profile
        correction = float(self.field.weight_correction[source])
        shape = measure_shape(facet, prior, profile, start, information_fraction=correction)
        # The neighbours are taken as known.
        shape = replace(shape, quality=replace(shape.quality, error_widening=1.0))
        return with_significance(shape, facet, prior, profile, correction)

    def _prior(self, source: int) -> ShapePrior:
        model = self.setting.model
        return self.field.prior(source, model.position_radius, model.ellipticity)
