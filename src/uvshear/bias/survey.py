"""Simulated surveys to be calibrated: galaxies alone in the beam, and fields observed whole."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from uvshear.bias.bias import Bias
from uvshear.bias.cell_average import CellAverageBeam
from uvshear.bias.crowded import FieldEstimator, FieldExperiment, calibrate_field
from uvshear.bias.experiment import Experiment
from uvshear.bias.isolated import Beam
from uvshear.constants import ARCMIN
from uvshear.diagnostics.natural_norms import natural_norms
from uvshear.execution import SERIAL, Executor
from uvshear.extraction import Extracted, MeasurementOptions
from uvshear.galaxy import Exponential, Galaxies, Profile, SizeFluxRelation
from uvshear.interferometer.coverage import synthesise
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.pipeline import extract
from uvshear.progress import Progress
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.observation import SimulatedObservation
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField

FITTED = Exponential()
"""Profile that noise and cuts go by, whatever the true one."""


@dataclass(frozen=True)
class Survey:
    """What is observed, behind which shears, and what is counted.

    Parameters
    ----------
    plan
        Of the observation.
    shears
        Reduced shears that add up to zero.
    population
        Fluxes, sizes and ellipticities.
    noise
        Its level.
    profile
        True brightness profile.
    lens
        What a shear does to galaxies.
    snr_min
        Galaxies whose catalogue flux makes for less, at the median size, are left out: no shear changes that.
    flux_min, flux_max
        Catalogue fluxes below and above which galaxies are left out [Jy].
    seed
        Of galaxies and noise.
    executor
        Of gridding and prediction.
    """

    plan: ObservingPlan
    shears: tuple[complex, ...]
    population: Population = field(default_factory=Population)
    noise: GalaxyNoise = field(default_factory=GalaxyNoise)
    profile: Profile = field(default_factory=Exponential)
    lens: Callable[[Galaxies, complex], Galaxies] = shear_galaxies
    snr_min: float = 0.0
    flux_min: float = 0.0
    flux_max: float = math.inf
    seed: int = 1
    executor: Executor = SERIAL

    def alone(self, *, averages_cells: bool = False) -> Experiment:
        """Galaxies alone in the beam, on exact facets or on the paper's."""
        empty = self._observed(self._nobody(), noise_seed=None)
        return Experiment(
            beam=CellAverageBeam.of(empty) if averages_cells else self._beam(empty),
            shears=self.shears,
            population=self.population,
            profile=self.profile,
            lens=self.lens,
            snr_min=self.snr_min,
            flux_min=self.flux_min,
            flux_max=self.flux_max,
            seed=self.seed,
        )

    def crowd(self, number: int, density: float) -> FieldExperiment:
        """So many galaxies together in the beam, at a density [arcmin^-2]."""
        side = math.sqrt(number / density) * ARCMIN
        galaxies = draw_population(
            self.population,
            SquareField(side),
            number=number,
            rng=np.random.default_rng(self.seed),
        )
        empty = self._observed(self._nobody(), noise_seed=self.seed)
        seen = VisibilitySet(self.plan.track.phase_centre, tuple(empty.chunks()))
        median = np.exp(SizeFluxRelation().prior(galaxies.flux).log_median)
        circles = replace(galaxies, scale_length=median, ellipticity=np.zeros(number, complex))
        snr = galaxies.flux * np.sqrt(natural_norms(seen, circles, FITTED, self.executor))
        used = (snr >= self.snr_min) & (galaxies.flux >= self.flux_min)
        used &= galaxies.flux <= self.flux_max
        return FieldExperiment(
            galaxies, seen, self.shears, used, self.lens, self.profile, self.executor
        )

    def _beam(self, empty: SimulatedObservation) -> Beam:
        faintest = self.population.size.prior(np.array([self.population.flux.minimum]))
        smallest = float(np.exp(faintest.log_median[0] - 2 * faintest.sigma[0]))
        return Beam.of(empty, self._nobody(), smallest, self.executor)

    def _nobody(self) -> Galaxies:
        """Return a galaxy without flux, of the population's spectral index."""
        median = self.population.size.prior(np.array([self.population.flux.minimum])).log_median
        return Galaxies(
            l=np.zeros(1),
            m=np.zeros(1),
            flux=np.zeros(1),
            scale_length=np.exp(median),
            ellipticity=np.zeros(1, complex),
            spectral_index=np.array([self.population.spectral_index]),
        )

    def _observed(self, galaxies: Galaxies, *, noise_seed: int | None) -> SimulatedObservation:
        plan = self.plan
        coverage = synthesise(plan.layout, plan.track)
        level = self.noise.scaled_to(coverage, plan.channels, FITTED, self.executor)
        return SimulatedObservation(
            coverage, plan.channels, galaxies, FITTED, level, noise_seed, self.executor
        )


def calibrate_crowded(
    experiment: FieldExperiment,
    estimators: Sequence[FieldEstimator],
    options: MeasurementOptions,
    step: Progress | None = None,
) -> list[list[Bias]]:
    """Bias of each estimator in a crowded field, through the whole measurement, made once for all of them."""
    statistics = tuple(statistic for one in estimators for statistic in one.statistics)
    keeping = replace(options, keep=statistics)

    def measured(observation: VisibilitySet, galaxies: Galaxies) -> Extracted:
        catalogue = catalogue_from_galaxies(galaxies, observation.phase_centre)
        return extract(observation, catalogue, keeping)[1]

    return calibrate_field(experiment, estimators, measured, step)
