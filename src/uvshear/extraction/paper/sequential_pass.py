"""Passes over the sources of a field in decreasing flux."""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from uvshear.extraction.extraction import Setting
from uvshear.extraction.field import Field
from uvshear.extraction.paper.facet_gathering import gather_facets
from uvshear.extraction.paper.facets import FacetMethod
from uvshear.extraction.schedule import fitting_levels
from uvshear.extraction.sky import with_fitted
from uvshear.galaxy import Galaxies
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Observation
from uvshear.progress import Progress
from uvshear.shapes.measurement import GalaxyFit, ShapeMeasurement
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import fit_galaxy, measure_shape
from uvshear.typing import Array, Float, Int

FACETS_AT_A_TIME = 64

Batch = Int[Array, "_"]
"""Sources that share a visit of the visibilities, as indices of the catalogue."""

Result = TypeVar("Result")


class Sweep:
    """A sky that improves with every fit, one batch of sources after the other."""

    def __init__(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        *,
        facet: FacetMethod,
        progress: Progress | None,
    ) -> None:
        self._observation, self._field, self._setting = observation, field, setting
        self._facet, self._progress = facet, progress
        self._sky = field.sky
        # What every round would gather again: 80 kB a source of median size.
        self._power: dict[int, Float[Array, " cell"]] = {}
        self._fits: dict[int, GalaxyFit] = {}
        self._rows_done = self._rows_expected = self._visits = 0

    @property
    def sky(self) -> Galaxies:
        """All sources of the catalogue, as they are known by now."""
        return self._sky

    @property
    def visits(self) -> int:
        """How often the visibilities were gone through."""
        return self._visits

    def batches(self, members: Int[Array, " member"], separation: float) -> list[Batch]:
        """Order sources by flux where they are closer than ``separation`` [rad], a visit each batch."""
        lm = np.column_stack([self._field.l, self._field.m])[members]
        levels = fitting_levels(lm, self._field.sky.flux[members], separation)
        return [
            members[level[first : first + FACETS_AT_A_TIME]]
            for level in levels
            for first in range(0, len(level), FACETS_AT_A_TIME)
        ]

    def expect(self, visits: int) -> None:
        """Tell of visits to come, for whoever watches."""
        self._rows_expected += visits * self._field.extent.rows

    def forget(self, sources: Sequence[int]) -> None:
        """Look for these sources anew, wherever they were found before; in the sky they stay."""
        for source in sources:
            self._fits.pop(source, None)

    def improve_sky(self, batches: Sequence[Batch]) -> None:
        """Fit every source once for the sky model."""
        for batch, fits in self._visit(batches, self._fit):
            self._update(batch, fits)

    def measure_shapes(self, batches: Sequence[Batch]) -> dict[int, ShapeMeasurement]:
        """Fit every source once, and sample the posterior of its ellipticity."""
        measurements: dict[int, ShapeMeasurement] = {}
        for batch, results in self._visit(batches, self._measure):
            measurements.update(zip(batch.tolist(), results, strict=True))
            self._update(batch, [result.best for result in results])
        return measurements

    def _visit(
        self,
        batches: Sequence[Batch],
        fit: Callable[[int, Facet], Result],
    ) -> Iterator[tuple[Batch, list[Result]]]:
        """Go through the batches, fitting the sources of one side by side against the sky as it is then."""
        for batch in batches:
            facets = self._facets(batch)
            pairs = zip(batch.tolist(), facets, strict=True)
            yield batch, list(self._setting.resources.executor.map(lambda pair: fit(*pair), pairs))

    def _fit(self, source: int, facet: Facet) -> GalaxyFit | None:
        prior, start = self._prior(source), self._fits.get(source)
        return fit_galaxy(facet, prior, self._setting.model.profile, start)

    def _measure(self, source: int, facet: Facet) -> ShapeMeasurement:
        prior, start = self._prior(source), self._fits.get(source)
        trust = float(self._field.trust[source])
        return measure_shape(facet, prior, self._setting.model.profile, start, information_fraction=trust)

    def _prior(self, source: int) -> ShapePrior:
        setting = self._setting
        return self._field.prior(source, setting.model.position_radius, setting.model.ellipticity)

    def _facets(self, batch: Batch) -> list[Facet]:
        field, setting = self._field, self._setting
        builders = [
            self._facet.open(
                field.target(source, self._fits.get(source)),
                setting.model.profile,
                self._power.get(source),
            )
            for source in batch.tolist()
        ]
        gather_facets(
            self._observation,
            self._sky.select(field.modelled),
            builders,
            np.searchsorted(field.modelled, batch),
            setting.model.profile,
            executor=setting.resources.executor,
            on_chunk=self._report,
        )
        self._visits += 1
        facets = [
            builder.facet(self._sky.select(np.array([source])))
            for source, builder in zip(batch, builders, strict=True)
        ]
        for source, facet in zip(batch.tolist(), facets, strict=True):
            self._power[source] = facet.power.astype(np.float32)
        return facets

    def _update(self, batch: Batch, fits: Sequence[GalaxyFit | None]) -> None:
        """Let good fits into the sky; where there is none, what stood there stays."""
        good = {s: fit for s, fit in zip(batch.tolist(), fits, strict=True) if fit is not None}
        self._fits |= good
        self._sky = with_fitted(self._sky, self._field, good)

    def _report(self, rows: int) -> None:
        self._rows_done += rows
        if self._progress is not None:
            self._progress(self._rows_done, self._rows_expected)
