"""The measurement on one page: visibilities and a catalogue in, shapes and shear out.

1. Read the observation once: how long are its baselines, is there anything (``interferometer.extent``). Its weights
   are 1/sigma^2 unless others are asked for (``measurement.weighed``).
2. Begin with a sky of round galaxies of the catalogue's fluxes and of median size.
3. Tell the sources apart (``measurement.extraction``): take everything modelled away, cut out a source
   (``extraction``), put its own model back, fit it (``fit``), and let the fitted galaxy replace the round one in
   the sky, until every source has been measured against a sky that is good.
4. Tabulate.
5. Turn ellipticities into shear (``shear``).
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from astropy.table import Table
from scipy.spatial import cKDTree

from uvshear.constants import REFERENCE_FREQUENCY
from uvshear.diagnostics.natural_snr import with_natural_snr
from uvshear.errors import InputError
from uvshear.estimators.estimator import BayesianShear, MeanShear, MetacalShear, MomentShear
from uvshear.estimators.evidence import UnlensedPopulation
from uvshear.estimators.mean import ShearEstimate
from uvshear.estimators.packing import PACKED, unpack
from uvshear.estimators.ratio import Responses
from uvshear.execution import SERIAL, Executor
from uvshear.extraction import Extracted, Field, MeasurementOptions
from uvshear.extraction.metacal import MetacalStatistic
from uvshear.extraction.weighted_shapes import weigh
from uvshear.galaxy import (
    Exponential,
    Galaxies,
    Profile,
    SizeFluxRelation,
)
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import synthesise
from uvshear.interferometer.noise import Noise
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.summary import Extent, measure_extent
from uvshear.interferometer.visibilities import Observation
from uvshear.io.catalogue import Catalogue, catalogue_from_table
from uvshear.io.shapes import inside, shapes_table
from uvshear.predict.response import FAINTEST, Response
from uvshear.progress import Progress
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.weight import lensfit_weight
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.observation import SimulatedObservation
from uvshear.typing import Array, Bool, Float, Int

Lens = Callable[[Galaxies, complex], Galaxies]
"""What a reduced shear does to galaxies."""


def simulate(
    catalogue: Catalogue | Table,
    plan: ObservingPlan,
    *,
    noise: Noise | GalaxyNoise | None = None,
    shear: complex = 0j,
    lens: Lens = shear_galaxies,
    profile: Profile | None = None,
    seed: int | None = 1,
    executor: Executor = SERIAL,
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
        noise = noise.scaled_to(coverage, plan.channels, profile, executor)
    return SimulatedObservation(
        coverage=coverage,
        channels=plan.channels,
        galaxies=lens(galaxies, shear),
        profile=profile,
        noise=noise,
        seed=seed,
        executor=executor,
        is_averaged=plan.is_averaged,
        primary_beam=plan.primary_beam,
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
    field, extracted = extract(observation, sources, options, progress=progress)
    return tabulate(sources, field, extracted, observation.phase_centre, options)


def extract(
    observation: Observation,
    catalogue: Catalogue,
    options: MeasurementOptions,
    *,
    progress: Progress | None = None,
) -> tuple[Field, Extracted]:
    """Measure the sources, and keep the sky that was found: what is left is the data less it.

    That is ``extracted.sky.select(field.modelled)`` with ``options.profile``. Weightings that are asked for are applied
    here; signal-to-noise ratios are those of natural weights all the same.
    """
    extent = measure_extent(observation)
    field = _prepare(catalogue, observation.phase_centre, extent, options)
    seen, among = observation, field
    if options.weightings and len(field.measured):
        seen, trust = weigh(observation, field, options)
        among = replace(field, extent=measure_extent(seen), trust=trust)
    extracted = options.extraction.measure(seen, among, options, progress)
    is_part = extracted.uv_range.minimum > 0 or options.uv_range.maximum < np.inf
    if not (is_part or options.weightings):
        return field, extracted
    attenuation = options.attenuation(observation.phase_centre.dec)
    if not options.extraction.models_losses:
        attenuation = None
    response = Response.from_sky(field.sky.select(field.modelled), extent.probes, attenuation)
    quoted = with_natural_snr(
        extracted.measurements,
        observation,
        extracted.sky,
        options.profile,
        options.executor,
        response,
    )
    return field, replace(extracted, measurements=quoted)


SAME_PLACE = 0.25
"""Sources closer than this part of the smaller one's median scale length are one."""


def _repeated(
    l: Float[Array, " source"],
    m: Float[Array, " source"],
    flux: Float[Array, " source"],
    scale_length: Float[Array, " source"],
    is_modelled: Bool[Array, " source"],
) -> Int[Array, " repeated"]:
    """Find the fainter of sources at one place; of equals, those that come later."""
    members = np.flatnonzero(is_modelled)
    place, size = np.column_stack([l, m])[members], scale_length[members]
    if len(members) == 0:
        return members
    pairs = cKDTree(place).query_pairs(SAME_PLACE * float(size.max()), output_type="ndarray")
    apart = np.hypot(*(place[pairs[:, 0]] - place[pairs[:, 1]]).T)
    pairs = pairs[apart < SAME_PLACE * np.minimum(size[pairs[:, 0]], size[pairs[:, 1]])]
    first, second = members[pairs.min(axis=1)], members[pairs.max(axis=1)]
    return np.unique(np.where(flux[first] >= flux[second], second, first))


def tabulate(
    catalogue: Catalogue,
    field: Field,
    extracted: Extracted,
    phase_centre: PhaseCentre,
    options: MeasurementOptions,
) -> Table:
    """Shapes of what was extracted; one row a source, in the catalogue's order."""
    results = [
        extracted.measurements.get(source, ShapeMeasurement.failed(flag))
        for source, flag in enumerate(field.flags)
    ]
    e = np.array([result.ellipticity for result in results])
    covariance = np.array([result.covariance for result in results])
    offset = np.array([result.offset for result in results])
    e_sigma = np.array([result.e_sigma for result in results])
    is_ok = np.array([result.flag is FitFlag.OK for result in results])
    columns = {
        "id": catalogue.identifier,
        "l": field.l,
        "m": field.m,
        "flux": catalogue.flux,
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
    if catalogue.ra is not None and catalogue.dec is not None:
        columns |= {"ra": catalogue.ra, "dec": catalogue.dec}
    return shapes_table(columns, phase_centre, record=extracted.record)


def estimate_shear(
    shapes: Table, *, snr_min: float = 0.0, flux_min: float = 0.0, seed: int = 1
) -> ShearEstimate:
    """Weighted mean ellipticity of the shapes, its error by bootstrap; see :func:`selected` for the cuts."""
    return mean_shear(shapes, seed).of(selected(shapes, snr_min=snr_min, flux_min=flux_min))


def mean_shear(shapes: Table, seed: int = 1) -> MeanShear:
    """Estimator by the weighted mean of ellipticities."""
    e = inside(shapes, "e1") + 1j * inside(shapes, "e2")
    return MeanShear(e, inside(shapes, "weight"), seed)


def moment_shear(shapes: Table, statistics: Table) -> MomentShear:
    """Estimator by the sum of moments over the sum of their responses; ``statistics`` as kept."""
    value = np.stack([np.array(statistics[name], float) for name in ("m1", "m2")], axis=-1)
    r11, r12, r22 = (np.array(statistics[name], float) for name in ("r11", "r12", "r22"))
    response = np.stack([r11, r12, r12, r22], axis=-1).reshape(-1, 2, 2)
    variance = (np.array(statistics["m1_var"]) + np.array(statistics["m2_var"])) / 2
    third = np.array(statistics["r_third"], float)
    return MomentShear(Responses(value, response), third, variance, inside(shapes, "flux"))


def metacal_shear(statistics: Table) -> MetacalShear:
    """Estimator by the sum of ellipticities over the sum of their responses; ``statistics`` as kept."""
    numbers = np.stack(
        [np.array(statistics[name], float) for name in MetacalStatistic.columns], axis=-1
    )
    return MetacalShear(Responses(numbers[:, :2], numbers[:, 2:].reshape(-1, 2, 2)))


def bayesian_shear(
    statistics: Table, population: UnlensedPopulation | None = None
) -> BayesianShear:
    """Estimator by likelihoods, ``statistics`` as kept, of galaxies from a population."""
    packed = (
        {name: np.asarray(value) for name, value in zip(PACKED, row, strict=True)}
        for row in statistics.iterrows(*PACKED)
    )
    # A table without a single likelihood has NaN in place of arrays.
    likelihoods = [
        unpack(one) if one["lattice"].ndim and len(one["lattice"]) else None for one in packed
    ]
    return BayesianShear(likelihoods, population or UnlensedPopulation())


def selected(
    shapes: Table, *, snr_min: float = 0.0, flux_min: float = 0.0
) -> Bool[Array, " source"]:
    """Galaxies without a flag, with a measured ``snr`` and a catalogue's flux [Jy] of at least so much.

    Shear and noise move galaxies across a cut by ``snr``, which biases any shear; a lens without magnification leaves
    the flux.
    """
    chosen = np.array(shapes["flag"] == "ok") & (inside(shapes, "snr") >= snr_min)
    if flux_min > 0:
        chosen &= inside(shapes, "flux") >= flux_min
    return chosen


def _prepare(
    sources: Catalogue, phase_centre: PhaseCentre, extent: Extent, options: MeasurementOptions
) -> Field:
    l, m, n = sources.directions(phase_centre)
    flags = np.full(len(sources), FitFlag.OK, dtype=object)
    if sources.scale_length is not None:
        flags[sources.scale_length == 0] = FitFlag.POINT_SOURCE
    flags[np.hypot(l, m) > np.sin(options.field_radius)] = FitFlag.OUTSIDE_FIELD
    flags[n <= 0] = FitFlag.BELOW_HORIZON
    if sources.is_point is not None:
        flags[sources.is_point & (flags == FitFlag.OK)] = FitFlag.POINT_SOURCE
    is_modelled = (flags == FitFlag.OK) | (flags == FitFlag.POINT_SOURCE)
    flux_at_1_4 = sources.flux * (REFERENCE_FREQUENCY / sources.reference_frequency) ** (
        sources.spectral_index
    )
    is_point = flags == FitFlag.POINT_SOURCE
    # A point has no size; what is scaled by one, the prior of its position say, takes a galaxy's of its flux.
    usual = np.exp(SizeFluxRelation().prior(flux_at_1_4).log_median)
    known_size = (
        None if sources.scale_length is None else np.where(is_point, usual, sources.scale_length)
    )
    size = options.size.prior(flux_at_1_4, known_size)
    repeated = _repeated(l, m, sources.flux, np.exp(size.log_median), is_modelled)
    flags[repeated] = FitFlag.DUPLICATE
    is_modelled[repeated] = False
    sky = Galaxies(
        l=np.where(is_modelled, l, 0.0),
        m=np.where(is_modelled, m, 0.0),
        flux=np.where(is_modelled, sources.flux, 0.0),
        scale_length=np.where(is_point, 0.0, np.exp(size.log_median)),
        ellipticity=np.zeros(len(sources), complex),
        spectral_index=sources.spectral_index,
        reference_frequency=sources.reference_frequency,
    )
    # What averaging and primary beams leave next to nothing of cannot be modelled.
    response = Response.from_sky(sky, extent.probes, options.attenuation(phase_centre.dec))
    unseen = is_modelled & (response.attenuations(sky) < FAINTEST)
    flags[unseen] = FitFlag.OUTSIDE_FIELD
    is_modelled &= ~unseen
    sky = replace(sky, flux=np.where(unseen, 0.0, sky.flux))
    if options.uv_range.minimum >= extent.longest:
        raise InputError(
            f"--uv-min {options.uv_range.minimum:g}: the longest baseline there is has {extent.longest:.4g}"
            " wavelengths; a lower uv-min is needed"
        )
    longest = min(options.uv_range.maximum, extent.longest)
    uv_range = replace(options.uv_range, maximum=longest)
    unknown = np.zeros(len(sources))
    return Field(
        l,
        m,
        sky,
        size,
        np.flatnonzero(is_modelled),
        flags,
        uv_range,
        extent,
        flux_err=unknown if sources.flux_err is None else sources.flux_err,
        position_err=unknown if sources.position_err is None else sources.position_err,
        trust=np.ones(len(sources)),
    )
