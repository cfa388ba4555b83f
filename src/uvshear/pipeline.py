"""The measurement on one page: visibilities and a catalogue in, shapes and shear out.

1. Read the observation once: how long are its baselines, is there anything (``interferometer.extent``).
2. Begin with a sky of round galaxies of the catalogue's fluxes and of median size.
3. In decreasing flux, side by side where they are far apart (``extraction.schedule``): subtract everything
   modelled, gather the facet of a source (``extraction.visit``), put its own model back, fit it (``fit``), and let
   the fitted galaxy replace the round one in the sky.
4. Again, with the better sky; in the last round sample the posterior of the ellipticity.
5. Turn ellipticities into shear (``shear``).
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from astropy.table import Table

from uvshear.constants import ARCSEC, REFERENCE_FREQUENCY
from uvshear.errors import InputError
from uvshear.extraction.exact import ExactFacets
from uvshear.extraction.facets import FacetMethod, Target, UvRange
from uvshear.extraction.natural import natural_norms
from uvshear.extraction.schedule import fitting_levels
from uvshear.extraction.visit import gather_facets
from uvshear.fit.measurement import FitFlag, GalaxyFit, ShapeMeasurement
from uvshear.fit.prior import ShapePrior
from uvshear.fit.shape import fit_galaxy, measure_shape
from uvshear.galaxy import (
    DiscEllipticityPrior,
    EllipticityPrior,
    Exponential,
    FlatEllipticityPrior,
    Galaxies,
    Profile,
    SizeFluxRelation,
    SizeModel,
    SizePrior,
)
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import synthesise
from uvshear.interferometer.extent import Extent, measure_extent
from uvshear.interferometer.facet import Facet
from uvshear.interferometer.noise import Noise
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.visibilities import Observation
from uvshear.io.catalogue import Catalogue, catalogue_from_table
from uvshear.io.shapes import inside, shapes_table
from uvshear.shear.mean import ShearEstimate, weighted_mean_shear
from uvshear.shear.weight import lensfit_weight
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.observation import SimulatedObservation
from uvshear.typing import Array, Float, Int, Shaped

Lens = Callable[[Galaxies, complex], Galaxies]
"""What a reduced shear does to galaxies."""

Progress = Callable[[int, int], None]
"""Called with what is done and what there is."""

FACETS_AT_A_TIME = 64


@dataclass(frozen=True)
class MeasurementOptions:
    """How to measure; every alternative is an object, and may be one of the user's own.

    Parameters
    ----------
    facet
        Way of making facets: ``ExactFacets`` or ``CellAverageFacets``.
    profile
        Brightness profile fitted.
    size
        Source of the prior on the scale length.
    ellipticity
        Prior of the posterior mean; flat over |e| < 0.95 unless given.
    population
        Distribution of intrinsic ellipticities, for the weights.
    uv_range
        Baselines that take part in the shape.
    position_radius
        Radius of the uniform prior on the position [rad]; None stands for one width of the correlation's peak.
    rounds
        Passes over the sources.
    separation
        Sources closer than this are fitted one after the other, the brighter first [rad].
    field_radius
        Sources farther from the phase centre are flagged and left alone [rad].
    threads
        Results do not depend on it.
    """

    facet: FacetMethod = field(default_factory=ExactFacets)
    profile: Profile = field(default_factory=Exponential)
    size: SizeModel = field(default_factory=SizeFluxRelation)
    ellipticity: EllipticityPrior = field(default_factory=FlatEllipticityPrior)
    population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)
    uv_range: UvRange = field(default_factory=UvRange)
    position_radius: float | None = None
    rounds: int = 2
    separation: float = 60 * ARCSEC
    field_radius: float = np.radians(5.0)
    threads: int = 1

    def __post_init__(self) -> None:
        if self.rounds < 1:
            raise InputError(f"{self.rounds} rounds; one or more are needed")


def simulate(
    catalogue: Catalogue | Table,
    plan: ObservingPlan,
    *,
    noise: Noise | GalaxyNoise | None = None,
    shear: complex = 0j,
    lens: Lens = shear_galaxies,
    profile: Profile | None = None,
    seed: int | None = 1,
    threads: int = 1,
) -> SimulatedObservation:
    """Let an array observe the galaxies of a catalogue.

    What comes back is an observation to be measured as it is; ``io.measurement_set_writer`` puts it into a
    Measurement Set.

    Parameters
    ----------
    noise
        By SEFD (``StokesINoise``, ``CorrelationNoise``), given (``ScaledNoise``), or by its effect
        (``GalaxyNoise``); the median galaxy of 10 uJy at a signal-to-noise ratio of 10 unless given.
    shear, lens
        Reduced shear of the galaxies, and what it does to them: ``shear_galaxies``, or the paper's
        ``shear_at_fixed_scale_length``.
    seed
        Of the noise; None adds none and keeps the weights.
    """
    profile = profile or Exponential()
    sources = catalogue_from_table(catalogue) if isinstance(catalogue, Table) else catalogue
    galaxies = sources.galaxies(plan.track.phase_centre)
    coverage = synthesise(plan.layout, plan.track)
    noise = noise or GalaxyNoise()
    if isinstance(noise, GalaxyNoise):
        noise = noise.scaled_to(coverage, plan.channels, profile, threads)
    return SimulatedObservation(
        coverage=coverage,
        channels=plan.channels,
        galaxies=lens(galaxies, shear),
        profile=profile,
        noise=noise,
        seed=seed,
    )


def measure(
    observation: Observation,
    catalogue: Catalogue | Table,
    options: MeasurementOptions | None = None,
    *,
    progress: Progress | None = None,
) -> Table:
    """Measure the shape of every source; one row each, in the catalogue's order.

    What goes wrong with a source is a flag in its row (``fit.measurement.FitFlag``); wrong inputs raise
    :class:`uvshear.errors.InputError`.
    """
    options = options or MeasurementOptions()
    sources = catalogue_from_table(catalogue) if isinstance(catalogue, Table) else catalogue
    extent = measure_extent(observation)
    field = _prepare(sources, observation.phase_centre, extent, options)
    sweep = _Sweep(observation, field, options, progress)
    for _ in range(options.rounds - 1):
        sweep.improve_sky()
    measurements = sweep.measure_shapes()
    return _tabulate(sources, field, measurements, observation.phase_centre, options)


def estimate_shear(shapes: Table, *, snr_min: float = 0.0, seed: int = 1) -> ShearEstimate:
    """Weighted mean ellipticity of the shapes with ``snr`` of at least ``snr_min``, its error by bootstrap."""
    e = inside(shapes, "e1") + 1j * inside(shapes, "e2")
    weight = inside(shapes, "weight")
    bright = inside(shapes, "snr") >= snr_min
    rng = np.random.default_rng(seed)
    return weighted_mean_shear(e[bright], weight[bright], rng)


@dataclass(frozen=True)
class _Field:
    """The sources as a measurement sees them; those that cannot be measured have a flag other than OK."""

    l: Float[Array, " source"]
    m: Float[Array, " source"]
    sky: Galaxies
    size: SizePrior
    modelled: Int[Array, " member"]
    flags: Shaped[Array, " source"]
    uv_range: UvRange
    extent: Extent

    @property
    def measured(self) -> Int[Array, " member"]:
        """Sources to be fitted, as indices of the catalogue."""
        return np.flatnonzero(self.flags == FitFlag.OK)


def _prepare(
    sources: Catalogue, phase_centre: PhaseCentre, extent: Extent, options: MeasurementOptions
) -> _Field:
    l, m, n = sources.directions(phase_centre)
    flags = np.full(len(sources), FitFlag.OK, dtype=object)
    if sources.scale_length is not None:
        flags[sources.scale_length == 0] = FitFlag.POINT_SOURCE
    flags[np.hypot(l, m) > np.sin(options.field_radius)] = FitFlag.OUTSIDE_FIELD
    flags[n <= 0] = FitFlag.BELOW_HORIZON
    is_modelled = (flags == FitFlag.OK) | (flags == FitFlag.POINT_SOURCE)
    flux_at_1_4 = sources.flux * (REFERENCE_FREQUENCY / sources.reference_frequency) ** (
        sources.spectral_index
    )
    is_point = flags == FitFlag.POINT_SOURCE
    known_size = (
        None if sources.scale_length is None else np.where(is_point, 1.0, sources.scale_length)
    )
    size = options.size.prior(flux_at_1_4, known_size)
    sky = Galaxies(
        l=np.where(is_modelled, l, 0.0),
        m=np.where(is_modelled, m, 0.0),
        flux=np.where(is_modelled, sources.flux, 0.0),
        scale_length=np.where(is_point, 0.0, np.exp(size.log_median)),
        ellipticity=np.zeros(len(sources), complex),
        spectral_index=sources.spectral_index,
        reference_frequency=sources.reference_frequency,
    )
    longest = min(options.uv_range.maximum, extent.longest)
    uv_range = replace(options.uv_range, maximum=longest)
    return _Field(l, m, sky, size, np.flatnonzero(is_modelled), flags, uv_range, extent)


Result = TypeVar("Result")


class _Sweep:
    """Passes over the sources in decreasing flux; the sky improves with every fit."""

    def __init__(
        self,
        observation: Observation,
        field: _Field,
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
        self._power: dict[int, Float[Array, " cell"]] = {}
        self._fits: dict[int, GalaxyFit] = {}
        self._rows_done = 0

    def improve_sky(self) -> None:
        """Fit every source once for the sky model."""
        for batch in self._batches:
            facets = self._facets(batch)
            fits = self._side_by_side(
                lambda source, facet: fit_galaxy(
                    facet, self._prior(source), self._options.profile, self._fits.get(source)
                ),
                batch,
                facets,
            )
            self._update(batch, fits)

    def measure_shapes(self) -> dict[int, ShapeMeasurement]:
        """Fit every source once more, and sample the posterior of its ellipticity."""
        measurements: dict[int, ShapeMeasurement] = {}
        for batch in self._batches:
            facets = self._facets(batch)
            results = self._side_by_side(
                lambda source, facet: measure_shape(
                    facet, self._prior(source), self._options.profile, self._fits.get(source)
                ),
                batch,
                facets,
            )
            measurements.update(zip(batch.tolist(), results, strict=True))
            self._update(batch, [result.best for result in results])
        return self._with_natural_snr(measurements)

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
            self._power[source] = facet.power
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

    def _side_by_side(
        self,
        fit: Callable[[int, Facet], Result],
        batch: Int[Array, " member"],
        facets: list[Facet],
    ) -> list[Result]:
        with ThreadPoolExecutor(self._options.threads) as pool:
            return list(pool.map(fit, batch.tolist(), facets))

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


def _tabulate(
    sources: Catalogue,
    field: _Field,
    measurements: dict[int, ShapeMeasurement],
    phase_centre: PhaseCentre,
    options: MeasurementOptions,
) -> Table:
    results = [
        measurements.get(source, ShapeMeasurement.failed(flag))
        for source, flag in enumerate(field.flags)
    ]
    e = np.array([result.ellipticity for result in results])
    covariance = np.array([result.covariance for result in results])
    offset = np.array([result.offset for result in results])
    e_sigma = np.array([result.e_sigma for result in results])
    is_ok = np.array([result.flag is FitFlag.OK for result in results])
    columns = {
        "id": sources.identifier,
        "l": field.l,
        "m": field.m,
        "flux": sources.flux,
        "e1": e[:, 0],
        "e2": e[:, 1],
        "e1_err": np.sqrt(covariance[:, 0, 0]),
        "e2_err": np.sqrt(covariance[:, 1, 1]),
        "e12_cov": covariance[:, 0, 1],
        "e_sigma": e_sigma,
        "weight": np.where(is_ok, lensfit_weight(e_sigma, options.population), 0.0),
        "snr": np.array([result.snr for result in results]),
        "scale_length": np.array([result.scale_length for result in results]),
        "scale_length_err": np.array([result.scale_length_err for result in results]),
        "flux_fit": np.array([result.flux for result in results]),
        "flux_fit_err": np.array([result.flux_err for result in results]),
        "dl": offset[:, 0],
        "dm": offset[:, 1],
        "flag": np.array([result.flag.word for result in results]),
    }
    if sources.ra is not None and sources.dec is not None:
        columns |= {"ra": sources.ra, "dec": sources.dec}
    return shapes_table(columns, phase_centre)
