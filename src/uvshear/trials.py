"""Simulated surveys to be calibrated: the beam that isolated galaxies are drawn in, and fields observed whole."""

from dataclasses import replace

import numpy as np

from uvshear.calibration.bias import Bias
from uvshear.calibration.crowded import FieldEstimator, FieldExperiment, calibrate_field
from uvshear.calibration.isolated import Beam
from uvshear.extraction.natural import natural_norms
from uvshear.galaxy import Exponential, Galaxies, SizeFluxRelation
from uvshear.interferometer.coverage import synthesise
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.measurement import Extracted, MeasurementOptions, Progress
from uvshear.pipeline import extract
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.observation import SimulatedObservation
from uvshear.simulation.population import Population


def beam_of(
    plan: ObservingPlan,
    population: Population,
    *,
    noise: GalaxyNoise | None = None,
    threads: int = 1,
) -> Beam:
    """Beam of an observation towards its phase centre, in which ``calibration`` puts galaxies of a population."""
    faintest = np.array([population.flux.minimum])
    size = population.size.prior(faintest)
    nothing = Galaxies(
        l=np.zeros(1),
        m=np.zeros(1),
        flux=np.zeros(1),
        scale_length=np.exp(size.log_median),
        ellipticity=np.zeros(1, complex),
        spectral_index=np.array([population.spectral_index]),
    )
    profile = Exponential()
    coverage = synthesise(plan.layout, plan.track)
    level = (noise or GalaxyNoise()).scaled_to(coverage, plan.channels, profile, threads)
    observation = SimulatedObservation(
        coverage, plan.channels, nothing, profile, level, None, threads
    )
    smallest = float(np.exp(size.log_median[0] - 2 * size.sigma[0]))
    return Beam.of(observation, nothing, smallest, threads)


def crowded_field(
    plan: ObservingPlan,
    galaxies: Galaxies,
    shears: tuple[complex, ...],
    *,
    noise: GalaxyNoise,
    snr_min: float = 0.0,
    seed: int = 1,
    threads: int = 1,
) -> FieldExperiment:
    """Galaxies together in the beam, to be calibrated; ``snr_min`` cuts by the SNR of a flux at the median size."""
    fitted = Exponential()
    coverage = synthesise(plan.layout, plan.track)
    level = noise.scaled_to(coverage, plan.channels, fitted, threads)
    nothing = replace(galaxies.select(np.array([0])), flux=np.zeros(1))
    empty = SimulatedObservation(coverage, plan.channels, nothing, fitted, level, seed, threads)
    seen = VisibilitySet(plan.track.phase_centre, tuple(empty.chunks()))
    median = np.exp(SizeFluxRelation().prior(galaxies.flux).log_median)
    round_ones = replace(
        galaxies, scale_length=median, ellipticity=np.zeros(len(galaxies), complex)
    )
    snr = galaxies.flux * np.sqrt(natural_norms(seen, round_ones, fitted, threads))
    return FieldExperiment(galaxies, seen, shears, snr >= snr_min, threads=threads)


def calibrate_crowded(
    experiment: FieldExperiment,
    estimator: FieldEstimator,
    options: MeasurementOptions,
    step: Progress | None = None,
) -> list[Bias]:
    """Bias of an estimator in a crowded field, through the whole measurement."""
    keeping = replace(options, keep=estimator.statistics)

    def measured(observation: VisibilitySet, galaxies: Galaxies) -> Extracted:
        catalogue = catalogue_from_galaxies(galaxies, observation.phase_centre)
        return extract(observation, catalogue, keeping)[1]

    return calibrate_field(experiment, estimator, measured, step)
