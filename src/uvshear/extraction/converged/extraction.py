"""All sources of a field together: visits of the visibilities, and in between everything that images can settle.

1. Visit: subtract all models from the visibilities, gather what is left as one facet a source
   (``extraction.residual``); the first time the beams too (``extraction.beams``), the first two times without the
   longest baselines.
2. Settle: fit the sources in turn and together until little moves any more (``measurement.settlement``).
3. Again, until what settling leaves undone is a small part of the noise.
4. Sample the posterior of every galaxy, and add what its neighbours, free, would change (``measurement.joint``).
5. If more is to be kept, settle once more with next to no prior on ellipticities, and take it from there.

What settling leaves undone: the beam is that of the nearest of a few directions, and the interaction of two sources
ends at some distance and some baseline length. Such errors are a tenth to a fifth of what changed since the visit, and
the next visit measures them: its residual is exact.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uvshear.constants import REFERENCE_FREQUENCY
from uvshear.execution import single_threaded_libraries
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.beams import NANOSECONDS, SIZE, Beams, directions, gather_beams
from uvshear.extraction.converged.major_cycle import (
    Gridding,
    ModelledSky,
    block_of,
    gather_residuals,
    work_of,
)
from uvshear.extraction.converged.minor_cycle import Settlement
from uvshear.extraction.converged.plan import VisitPlan, Wanted, plan_visit
from uvshear.extraction.converged.sources import GalaxySource, ModelledSource, PointSource
from uvshear.extraction.extraction import Extracted, Extraction, Setting
from uvshear.extraction.field import Field
from uvshear.extraction.sky import with_fitted
from uvshear.imaging.bands import OVERSAMPLING
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation
from uvshear.predict.response import Response
from uvshear.progress import Meter, Progress
from uvshear.shapes.measurement import FitFlag, GalaxyFit, ShapeMeasurement
from uvshear.shapes.neighbours import with_neighbours_marginalised
from uvshear.shapes.residual_significance import SIGNIFICANT, residual_significance
from uvshear.shapes.shape import measure_shape
from uvshear.shapes.source_facet import Kept, SourceFacet, noise_named
from uvshear.typing import Array

POINT_STAMP = 128
"""Finest pixels across a point source: its image rings until the taper has worn off."""

ROUGH = 0.3
"""Change that counts as none after the first visit: what is left undone is more than that."""

ASTROMETRY = 0.3
"""Standard deviation of the catalogue's positions over the median scale length, for the sky model and unless known:
loose for a source that can be measured, tight enough to keep neighbours from changing places."""

ERROR, FINEST = 0.1, 1e-5
"""Error of the gridder over the noise, for the brightest source; and the least in single precision."""

PHOTOMETRY, SUREST = 0.3, 0.05
"""Standard deviation of the catalogue's fluxes over themselves, for the sky model: two galaxies at one beam from one
another are told apart by little else; and the least of what a catalogue gives."""

PEAKS = 1
"""Visits after which every source looks for its peak from scratch."""

WITHOUT_LONGEST = 2
"""Visits without the longest baselines, which cost two thirds of one: with one such visit the sky of 2195 galaxies is
the same after three (slopes within 1e-4, left undone 0.059 against 0.064)."""

COUPLED = 2
"""Visits after which couplings are worked out."""


@dataclass(frozen=True)
class ConvergedExtraction(Extraction):
    """Sources subtracted from one another until their sky no longer changes.

    Parameters
    ----------
    tolerance
        Change that counts as none, in units of the noise (the square root of <dm, dm>): rms over the sources.
    most_visits
        Of the visibilities with a sky to subtract; one more gathers the beams.
    scale_lengths
        Width of a facet over the median scale length; wider for galaxies found to be larger.
    epsilon
        Relative error of the gridder, where no source is so bright that it must be smaller.
    shortest
        Baseline below which visibilities are left out [wavelengths], unless the uv range asks for more; by default
        those that tell nothing of shapes (``measurement.baselines``), 0 for none.
    """

    models_attenuation = True
    keeps_statistics = True

    tolerance: float = 0.1
    most_visits: int = 5
    scale_lengths: float = 45.0
    epsilon: float = 1e-4
    shortest: float | None = None

    def extract(
        self,
        observation: Observation,
        field: Field,
        setting: Setting,
        progress: Progress | None = None,
    ) -> Extracted:
        """Measure every source of ``field.measured``, all others of ``field.modelled`` subtracted."""
        if len(field.modelled) == 0:
            record = {"extraction": "converged", "visits": 0}
            return Extracted({}, field.sky, field.uv_range, record)
        # Threads of the linear algebra would fight those of the fits, and change the last bits.
        with single_threaded_libraries():
            return _Run(self, observation, field, setting, progress).measure()


class _Run:
    """One measurement: what the steps share."""

    def __init__(
        self,
        method: ConvergedExtraction,
        observation: Observation,
        field: Field,
        setting: Setting,
        progress: Progress | None,
    ) -> None:
        self._method, self._observation, self._field = method, observation, field
        self._setting = setting
        self._members = field.modelled
        sky = field.sky.select(self._members)
        extent = field.extent
        self._response = Response.from_sky(
            sky, extent.probes, setting.model.attenuation(observation.phase_centre.dec)
        )
        self._common = self._response.strengths(sky)
        to_1_4_ghz = (REFERENCE_FREQUENCY / sky.reference_frequency) ** sky.spectral_index
        self._at_1_4_ghz = self._common / to_1_4_ghz
        self._is_galaxy = field.flags[self._members] == FitFlag.OK
        self._expected = [
            GalaxyFit(float(flux), np.zeros(2), 0j, float(size), 0.0)
            for flux, size in zip(sky.flux * self._common, sky.scale_length, strict=True)
        ]
        self._sources: list[ModelledSource] = []
        self._baselines = Baselines.of(field, self._is_galaxy, method.shortest)
        # What the gridder errs by shall be below the noise of the brightest source.
        snr = float(sky.flux.max()) * math.sqrt(extent.weight)
        epsilon = min(method.epsilon, max(ERROR / snr, FINEST))
        self._gridding = Gridding(
            epsilon, block_of(setting.resources.memory), setting.resources.executor
        )
        self._meter = Meter(progress)
        self._kept: dict[int, Kept] = {}

    def measure(self) -> Extracted:
        field, method, setting = self._field, self._method, self._setting
        fits: Sequence[GalaxyFit] = self._expected
        beams: Beams | None = None
        settlement: Settlement | None = None
        history: list[tuple[float, float]] = []
        rounds: list[list[tuple[float, float]]] = []
        while True:
            is_rough = len(history) < min(WITHOUT_LONGEST, method.most_visits - 1)
            plan = self._plan(fits, is_rough=is_rough)
            self._foresee(plan, is_first=beams is None)
            if beams is None:
                beams = self._gather_beams(plan)
                self._sources = self._describe()
            residuals = gather_residuals(
                self._observation, plan, self._sky(fits), self._gridding, self._meter.add
            )
            couplings = settlement.couplings if settlement and len(history) >= COUPLED else None
            settlement = Settlement(self._sources, fits, plan, beams, residuals, couplings)
            rounds.append(
                settlement.settle(
                    method.tolerance if history else max(method.tolerance, ROUGH),
                    setting.resources.executor,
                    afresh=len(history) < PEAKS,
                    tick=self._fitted,
                )
            )
            changes = settlement.changes()
            history.append((float(np.sqrt(np.mean(changes**2))), float(changes.max())))
            fits = settlement.fits
            left, most_left = _left_undone(history)
            # A visit without the longest baselines is never the last.
            if plan.top == 0 and (left < method.tolerance or len(history) >= method.most_visits):
                break
        measurements = self._measure_shapes(settlement)
        found = {
            int(source): self._in_catalogue_flux(k, fit)
            for k, (source, fit) in enumerate(zip(self._members, fits, strict=True))
        }
        sky = with_fitted(field.sky, field, found)
        released: list[float] = []
        if setting.keep:
            released = settlement.release(
                method.tolerance / 2, setting.resources.executor, self._fitted
            )
            self._keep_statistics(settlement)
        self._meter.finish()
        record: dict[str, object] = {
            "extraction": "converged",
            "visits": len(history),
            "shortest_baseline": round(self._baselines.shortest, 1),
            "rounds": [[[round(x, 3) for x in pair] for pair in visit] for visit in rounds],
            "change_rms": [round(rms, 4) for rms, _ in history],
            "change_max": [round(largest, 4) for _, largest in history],
            "left_undone": round(left, 4),
            "left_undone_most": round(most_left, 4),
            "tolerance": method.tolerance,
        }
        if released:
            record["released"] = [round(rms, 4) for rms in released]
        used = self._baselines
        uv_range = UvRange(used.shortest, field.uv_range.maximum)
        return Extracted(measurements, sky, uv_range, record, self._kept)

    def _describe(self) -> list[ModelledSource]:
        field, setting = self._field, self._setting
        median = np.exp(field.size.log_median[self._members])
        population = math.sqrt(setting.model.population.population_variance)
        sources: list[ModelledSource] = []
        for k, member in enumerate(self._members.tolist()):
            flux, given = self._expected[k].flux, setting.model.position_radius
            sigma = ASTROMETRY * median[k] if given is None else given / 2
            flux_sigma = PHOTOMETRY * flux
            if given is None and field.position_err[member] > 0:
                sigma = field.position_err[member]
            if field.flux_err[member] > 0:
                # A finder has it from the same data: taken at its word it would count twice.
                flux_sigma = max(field.flux_err[member] * self._common[k], SUREST * flux)
            prior = replace(
                field.prior(member, setting.model.position_radius, setting.model.ellipticity),
                ellipticity_sigma=population,
                position_sigma=sigma,
                flux=flux,
                flux_sigma=flux_sigma,
            )
            kind = GalaxySource if self._is_galaxy[k] else PointSource
            sources.append(kind(prior, setting.model.profile, self._expected[k]))
        return sources

    def _plan(self, fits: Sequence[GalaxyFit], *, is_rough: bool) -> VisitPlan:
        field, members = self._field, self._members
        median = np.exp(field.size.log_median[members])
        least = self._method.scale_lengths * median
        narrowest = float(least[self._is_galaxy].min()) if self._is_galaxy.any() else math.inf
        width = np.maximum(least, [2 * fit.half_width for fit in fits])
        width = np.where(self._is_galaxy, width, narrowest)
        pixel = 1 / (2 * OVERSAMPLING * self._baselines.finest)
        used = self._baselines
        width = np.minimum(width, 0.8 * SIZE * pixel)
        wanted = Wanted(field.l[members], field.m[members], width, used.uv_max)
        plan = plan_visit(wanted, used.shortest, used.longest, used.finest)
        if not is_rough or len(plan.bands) == 1:
            return plan
        # Circles become ellipses without the longest baselines, the dearest to visit.
        longest = min(plan.bands[0].shortest, used.longest)
        return plan_visit(wanted, used.shortest, longest, used.finest)

    def _sky(self, fits: Sequence[GalaxyFit]) -> ModelledSky:
        field = self._field
        found = {
            int(source): self._in_catalogue_flux(k, fit)
            for k, (source, fit) in enumerate(zip(self._members, fits, strict=True))
        }
        sky = with_fitted(field.sky, field, found).select(self._members)
        pixel = 1 / (2 * OVERSAMPLING * self._baselines.finest)
        half = np.array([fit.half_width for fit in fits])
        median = np.exp(field.size.log_median[self._members])
        half = np.maximum(half, self._method.scale_lengths / 2 * median)
        half = np.where(self._is_galaxy, half, POINT_STAMP / 2 * pixel)
        return ModelledSky(sky, half, self._response, self._setting.model.profile)

    def _in_catalogue_flux(self, k: int, fit: GalaxyFit) -> GalaxyFit:
        return replace(fit, flux=fit.flux / float(self._common[k]))

    def _gather_beams(self, plan: VisitPlan) -> Beams:
        field = self._field
        lm = np.column_stack([field.l, field.m])[self._members]
        uv_range = (self._baselines.shortest, self._baselines.longest)
        return gather_beams(
            self._observation,
            lm,
            uv_range,
            plan.pixel,
            self._response,
            self._gridding,
            self._meter.add,
        )

    def _measure_shapes(self, settlement: Settlement) -> Mapping[int, ShapeMeasurement]:
        profile = self._setting.model.profile
        chosen = np.flatnonzero(self._is_galaxy)
        galaxies = chosen.tolist()
        freedoms = dict(zip(galaxies, settlement.freedoms(chosen), strict=True))

        def sample(k: int) -> ShapeMeasurement:
            source, fit, neighbours = self._sources[k], settlement.fits[k], freedoms[k]
            share = 1.0 if neighbours is None else neighbours.share
            start = fit if fit.snr > 0 else None
            facet = settlement.facet(k)
            trust = float(self._field.trust[self._members[k]])
            known = share * trust
            shape = measure_shape(
                facet, source.prior.measured, profile, start, information_fraction=known
            )
            if shape.flag is FitFlag.OK:
                size = math.exp(source.prior.log_scale_length)
                left = residual_significance(settlement.residual(k), profile, size)
                if left > SIGNIFICANT:
                    shape = replace(shape, flag=FitFlag.CONTAMINATED)
            if neighbours is None:
                return shape
            held, free = neighbours.held / trust, neighbours.free / trust
            return with_neighbours_marginalised(shape, held, free, neighbours.shift, share)

        measurements = {}
        shapes = self._setting.resources.executor.map(sample, galaxies)
        for k, shape in zip(galaxies, shapes, strict=True):
            self._meter.add(_POSTERIOR)
            ratio = float(self._common[k])
            best = None if shape.best is None else self._in_catalogue_flux(k, shape.best)
            measurements[int(self._members[k])] = replace(
                shape, flux=shape.flux / ratio, flux_err=shape.flux_err / ratio, best=best
            )
        return measurements

    def _fitted(self) -> None:
        self._meter.add(_FIT)

    def _keep_statistics(self, settlement: Settlement) -> None:
        chosen = np.flatnonzero(self._is_galaxy).tolist()

        def keep(k: int) -> None:
            self._keep(k, settlement.facet(k), settlement.cutout(k))

        for _ in self._setting.resources.executor.map(keep, chosen):
            self._meter.add(_STATISTICS)

    def _keep(self, k: int, facet: Facet, cutout: Cutout) -> None:
        if not np.any(facet.power > 0):
            return
        ratio, prior = float(self._at_1_4_ghz[k]), self._sources[k].prior.measured
        source, model = int(self._members[k]), self._setting.model
        name = self._field.name(source, self._observation.phase_centre)
        # Populations know fluxes at 1.4 GHz, whatever those of the catalogue and of the facet are.
        seen = SourceFacet(
            facet=facet.in_other_unit(ratio),
            cells=cutout,
            prior=prior,
            flux=float(self._field.sky.flux[source]),
            profile=model.profile,
            population=model.population,
            draw_noise=noise_named(name, len(facet.power)),
        )
        numbers: dict[str, float | Array] = {}
        for statistic in self._setting.keep:
            numbers.update(statistic.statistic(seen) or {})
        if numbers:
            self._kept[source] = numbers

    def _foresee(self, plan: VisitPlan, *, is_first: bool) -> None:
        """Tell the meter what is to come: rough visits and one of all baselines are taken for granted, more are not."""
        visit = self._work_of(plan)
        if is_first:
            rough = min(WITHOUT_LONGEST, self._method.most_visits - 1)
            whole = self._work_of(self._plan(self._expected, is_rough=False))
            lm = np.column_stack([self._field.l, self._field.m])[self._members]
            nodes, _ = directions(lm)
            self._meter.expect(NANOSECONDS * self._field.extent.samples * len(nodes))
            self._meter.expect(rough * visit + whole)
            galaxies = int(self._is_galaxy.sum())
            self._meter.expect(galaxies * _POSTERIOR)
            if self._setting.keep:
                self._meter.expect(galaxies * (_FIT + _STATISTICS))
            self._visits_expected = rough + 1
        elif self._visits_expected > 1:
            self._visits_expected -= 1
        else:
            self._meter.expect(visit)

    def _work_of(self, plan: VisitPlan) -> float:
        samples = self._field.extent.samples // len(plan.bands)
        tiles = [tile for band in plan.tiles[plan.top :] for tile in band]
        return sum(work_of(samples, tile) for tile in tiles) + len(self._members) * _FIT


_FIT = 4e6
_POSTERIOR = 12e6
_STATISTICS = 20e6
"""Cost of a fit, of a posterior and of what is kept beside it [nanoseconds]."""


def _left_undone(history: list[tuple[float, float]]) -> tuple[float, float]:
    """Change that another visit would bring, rms and largest: they shrink from visit to visit by about one factor."""
    if len(history) == 1:
        return history[0]
    (before, _), (rms, largest) = history[-2:]
    shrinkage = min(rms / before, 1.0) if before > 0 else 0.0
    return rms * shrinkage, largest * shrinkage
