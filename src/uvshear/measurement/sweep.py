"""Passes over the sources of a field in decreasing flux."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TypeVar

import numpy as np

from uvshear.extraction.facets import Target
from uvshear.extraction.natural import natural_norms
from uvshear.extraction.schedule import fitting_levels
from uvshear.extraction.visit import gather_facets
from uvshear.fit.measurement import GalaxyFit, ShapeMeasurement
from uvshear.fit.prior import ShapePrior
from uvshear.fit.shape import fit_galaxy, measure_shape
from uvshear.galaxy import Profile
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.visibilities import Observation
from uvshear.measurement.field import Field
from uvshear.measurement.options import MeasurementOptions
from uvshear.typing import Array, Float, Int

Progress = Callable[[int, int], None]
"""Called with what is done and what there is."""

FACETS_AT_A_TIME = 64

Result = TypeVar("Result")


class Sweep:
    """Passes over the sources in decreasing flux; the sky improves with every fit."""

    def __init__(
        self,
        observation: Observation,
        field: Field,
        options: MeasurementOptions,
        progress: Progress | None,
    ) -> None:
        self._observation, self._field, self._options = observation, field, options
        self._progress = progress
        measured = field.measured
        lm = np.column_stack([field.l, field.m])[measured]
        levels = fitting_levels(lm, field.sky.flux[measured], options.separation)
        self._batches = [
            measured[level[first : first + FACETS_AT_A_TIME]]
            for level in levels
            for first in range(0, len(level), FACETS_AT_A_TIME)
        ]
        self._sky = field.sky
        # What every round would gather again: 80 kB a source of median size.
        self._power: dict[int, Float[Array, " cell"]] = {}
        self._fits: dict[int, GalaxyFit] = {}
        self._rows_done = 0

    def improve_sky(self) -> None:
        """Fit every source once for the sky model."""
        for batch, fits in self._visits(fit_galaxy):
            self._update(batch, fits)

    def measure_shapes(self) -> dict[int, ShapeMeasurement]:
        """Fit every source once more, and sample the posterior of its ellipticity."""
        measurements: dict[int, ShapeMeasurement] = {}
        for batch, results in self._visits(measure_shape):
            measurements.update(zip(batch.tolist(), results, strict=True))
            self._update(batch, [result.best for result in results])
        return self._with_natural_snr(measurements)

    def _visits(
        self, fit: Callable[[Facet, ShapePrior, Profile, GalaxyFit | None], Result]
    ) -> Iterator[tuple[Int[Array, " member"], list[Result]]]:
        """Go through the batches, fitting the sources of one side by side against the sky as it is then."""
        for batch in self._batches:
            facets = self._facets(batch)
            with ThreadPoolExecutor(self._options.threads) as pool:
                tasks = [
                    pool.submit(
                        fit,
                        facet,
                        self._prior(source),
                        self._options.profile,
                        self._fits.get(source),
                    )
                    for source, facet in zip(batch.tolist(), facets, strict=True)
                ]
                yield batch, [task.result() for task in tasks]

    def _facets(self, batch: Int[Array, " member"]) -> list[Facet]:
        field, options = self._field, self._options
        builders = [
            options.facet.open(self._target(source), options.profile, self._power.get(source))
            for source in batch.tolist()
        ]
        sky = self._sky.select(field.modelled)
        members = np.searchsorted(field.modelled, batch)
        gather_facets(
            self._observation,
            sky,
            builders,
            members,
            options.profile,
            threads=options.threads,
            on_chunk=self._report,
        )
        facets = [
            builder.facet(self._sky.select(np.array([source])))
            for source, builder in zip(batch, builders, strict=True)
        ]
        for source, facet in zip(batch.tolist(), facets, strict=True):
            self._power[source] = facet.power.astype(np.float32)
        return facets

    def _target(self, source: int) -> Target:
        field = self._field
        return Target(
            galaxy=field.sky.select(np.array([source])),
            scale_length=float(np.exp(field.size.log_median[source])),
            uv_range=field.uv_range,
            frequency=field.extent.frequency,
            half_width=fit.half_width if (fit := self._fits.get(source)) else 0.0,
        )

    def _prior(self, source: int) -> ShapePrior:
        size, options = self._field.size, self._options
        return ShapePrior(
            log_scale_length=float(size.log_median[source]),
            log_scale_length_sigma=float(size.sigma[source]),
            position_radius=options.position_radius,
            ellipticity=options.ellipticity,
        )

    def _update(self, batch: Int[Array, " member"], fits: list[GalaxyFit | None]) -> None:
        """Let fitted galaxies replace what stood in the sky; a source that was not fitted stays as it was."""
        sky, field = self._sky, self._field
        l, m, flux = sky.l.copy(), sky.m.copy(), sky.flux.copy()
        scale_length, ellipticity = sky.scale_length.copy(), sky.ellipticity.copy()
        for source, fit in zip(batch.tolist(), fits, strict=True):
            if fit is None:
                continue
            self._fits[source] = fit
            l[source] = field.l[source] + fit.offset[0]
            m[source] = field.m[source] + fit.offset[1]
            flux[source], scale_length[source] = fit.flux, fit.scale_length
            ellipticity[source] = fit.ellipticity
        self._sky = replace(
            sky, l=l, m=m, flux=flux, scale_length=scale_length, ellipticity=ellipticity
        )

    def _with_natural_snr(
        self, measurements: dict[int, ShapeMeasurement]
    ) -> dict[int, ShapeMeasurement]:
        """Quote the signal-to-noise ratio of natural weights, whatever baselines the shape was taken from."""
        if self._options.uv_range.is_everything or not measurements:
            return measurements
        order = np.array(list(measurements))
        norms = natural_norms(
            self._observation, self._sky.select(order), self._options.profile, self._options.threads
        )
        return {
            source: replace(
                measurements[source], snr=measurements[source].flux * float(np.sqrt(norm))
            )
            for source, norm in zip(order.tolist(), norms, strict=True)
        }

    def _report(self, rows: int) -> None:
        self._rows_done += rows
        if self._progress is not None:
            visits = self._options.rounds * len(self._batches)
            self._progress(self._rows_done, visits * self._field.extent.rows)
