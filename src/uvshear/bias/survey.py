"""The survey whose galaxies are simulated: its observation, and the cuts that select galaxies."""

import math
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from uvshear.bias.cell_average import CellAverageBeam
from uvshear.bias.crowded import FieldExperiment
from uvshear.bias.isolated import FITTED, Experiment
from uvshear.bias.mock_facets import MockBeam
from uvshear.constants import ARCMIN
from uvshear.diagnostics.natural_snr import natural_norms
from uvshear.errors import InputError
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.accumulate import accumulate
from uvshear.interferometer.baseline_map import BaselineMapAccumulator
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.pipeline.simulate import Lens
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.observation import SimulatedObservation
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField


@dataclass(frozen=True)
class Survey:
    """An observation of a population, and the cuts that select galaxies.

    Parameters
    ----------
    plan
        Array, track and channels.
    population
        Distributions of fluxes, sizes and ellipticities.
    noise
        Level of the noise.
    profile
        True brightness profile.
    lens
        Function that applies a shear to galaxies.
    snr_min
        Signal-to-noise ratio below which galaxies are left out, computed from the catalogue's flux and the median size,
        so that shear does not move galaxies across the cut.
    measured_snr_min
        Signal-to-noise ratio of the fit below which a measurement is left out. Only for isolated galaxies.
    flux_min, flux_max
        Catalogue fluxes below and above which galaxies are left out [Jy].
    position_sigma
        Standard error of the catalogue's positions in l and in m [rad]. Only for isolated galaxies.
    has_rings
        Whether galaxies are simulated with e and -e; in a crowded field they always are.
    averages_cells
        Whether facets are the paper's, which average in cells. Only for isolated galaxies.
    """

    plan: ObservingPlan
    population: Population = field(default_factory=Population)
    noise: GalaxyNoise = field(default_factory=GalaxyNoise)
    profile: Profile = field(default_factory=Exponential)
    lens: Lens = shear_galaxies
    snr_min: float = 0.0
    measured_snr_min: float = 0.0
    flux_min: float = 0.0
    flux_max: float = math.inf
    position_sigma: float = 0.0
    has_rings: bool = True
    averages_cells: bool = False

    @classmethod
    def of_the_paper(cls) -> Self:
        """Return 8 h of SKA-Mid AA4 at declination -30 deg in integrations of 300 s, one channel of 950 to 1190 MHz."""
        centre = PhaseCentre(0.0, math.radians(-30.0))
        track = Track.from_clock(centre, ((-4 * 3600, 4 * 3600),), 300.0)
        channels = Channels.from_band(950e6, 1190e6, 1)
        return cls(ObservingPlan(load_layout("ska-mid-aa4"), track, channels), snr_min=10.0)

    def isolated(
        self, shears: tuple[complex, ...], seed: int = 1, executor: Executor = SERIAL
    ) -> Experiment:
        """Return the experiment with isolated galaxies, on exact facets or on the paper's."""
        empty = self._observed(self._nobody(), None, executor)
        beam = (
            CellAverageBeam.gather(empty, self._nobody())
            if self.averages_cells
            else MockBeam.gather(empty, self._nobody(), self._smallest(), executor)
        )
        return Experiment(
            beam=beam,
            shears=shears,
            population=self.population,
            profile=self.profile,
            lens=self.lens,
            snr_min=self.snr_min,
            measured_snr_min=self.measured_snr_min,
            flux_min=self.flux_min,
            flux_max=self.flux_max,
            position_sigma=self.position_sigma,
            has_rings=self.has_rings,
            seed=seed,
        )

    def crowd(
        self,
        shears: tuple[complex, ...],
        number: int,
        density: float,
        seed: int = 1,
        executor: Executor = SERIAL,
    ) -> FieldExperiment:
        """Return the experiment with galaxies that share a crowded field.

        Parameters
        ----------
        number
            Number of galaxies.
        density
            Number of galaxies per square arcminute.
        """
        usual = replace(
            self, measured_snr_min=0.0, position_sigma=0.0, has_rings=True, averages_cells=False
        )
        if usual != self:
            raise InputError(
                "measured_snr_min, position_sigma, has_rings=False and averages_cells apply only to isolated galaxies;"
                " leave them out, or leave out the density"
            )
        side = math.sqrt(number / density) * ARCMIN
        galaxies = draw_population(
            self.population, SquareField(side), number=number, rng=np.random.default_rng(seed)
        )
        empty = self._observed(self._nobody(), seed, executor)
        seen = VisibilitySet(self.plan.track.phase_centre, tuple(empty.chunks()))
        median = np.exp(SizeFluxRelation().prior(galaxies.flux).log_median)
        circles = replace(galaxies, scale_length=median, ellipticity=np.zeros(number, complex))
        (cells,) = accumulate(seen, [BaselineMapAccumulator()])
        snr = galaxies.flux * np.sqrt(natural_norms(cells, circles, FITTED, executor))
        used = (snr >= self.snr_min) & (galaxies.flux >= self.flux_min)
        used &= galaxies.flux <= self.flux_max
        return FieldExperiment(galaxies, seen, shears, used, self.lens, self.profile, executor)

    def _smallest(self) -> float:
        """Return the scale length two standard deviations below the median of the faintest galaxies [rad]."""
        faintest = self.population.size.prior(np.array([self.population.flux.minimum]))
        return float(np.exp(faintest.log_median[0] - 2 * faintest.sigma[0]))

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

    def _observed(
        self, galaxies: Galaxies, noise_seed: int | None, executor: Executor
    ) -> SimulatedObservation:
        plan = self.plan
        coverage = synthesise(plan.layout, plan.track)
        level = self.noise.scaled_to(coverage, plan.channels, FITTED, executor)
        return SimulatedObservation(
            coverage, plan.channels, galaxies, FITTED, level, noise_seed, executor
        )
