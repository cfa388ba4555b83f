"""Surveys of isolated galaxies at the phase centre, whose shapes are measured in one way or another."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from uvshear.bias.isolated import FITTED, Experiment
from uvshear.constants import MICROJANSKY, SPEED_OF_LIGHT
from uvshear.diagnostics.weighting_loss import weighting_loss
from uvshear.galaxy import Exponential, Galaxies
from uvshear.interferometer.weighting import Weighting, weighted
from uvshear.reproduce.facet_ways import FacetWay, WeighedSamples, smallest_scale_length
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import Template
from uvshear.simulation.lensing import shear_at_fixed_scale_length
from uvshear.simulation.population import Population


@dataclass(frozen=True)
class MockSurvey:
    """Isolated galaxies of a population, their noise and the way of their facets.

    Parameters
    ----------
    facets
        Way to make facets.
    pointing
        The observation.
    weightings
        Weightings of the visibilities; natural weights without any.
    population
        Distributions of fluxes, sizes and ellipticities.
    flux, snr
        Signal-to-noise ratio of a round galaxy of this flux [Jy] and of the median size, with natural weights; they set
        the noise. The flux does not change with frequency.
    shears
        Reduced shears in the frame of (l, m).
    lens
        Function that applies a shear to galaxies.
    seed
        Seed of galaxies and noise.
    """

    facets: FacetWay
    pointing: PaperPointing = BASELINE
    weightings: tuple[Weighting, ...] = ()
    population: Population = field(default_factory=Population)
    flux: float = 10 * MICROJANSKY
    snr: float = 10.0
    shears: tuple[complex, ...] = (0j,)
    lens: Callable[[Galaxies, complex], Galaxies] = shear_at_fixed_scale_length
    seed: int = 1

    def experiment(self) -> Experiment:
        """Return the simulated experiment; the last ones are kept."""
        return _experiment(self)

    def samples(self) -> WeighedSamples:
        """Return the samples with their weights."""
        seen = self.pointing.unit_visibilities()
        (unit,) = seen.blocks
        uv = unit.uvw[:, :2] * (float(unit.frequency[0]) / SPEED_OF_LIGHT)
        median = float(self.population.size.median(np.array([self.flux]))[0])
        round_galaxy = GalaxyFit(self.flux, np.zeros(2), 0j, median, 0.0)
        power = float(np.sum(np.abs(Template(uv, FITTED).model(round_galaxy)) ** 2, dtype=float))
        natural = np.full(unit.stokes_i.shape, self.snr**2 / power)
        empty = WeighedSamples(unit, seen, np.ones(natural.shape), 1.0)
        seen = empty.with_weights(natural)
        (block,) = seen.blocks
        if not self.weightings:
            return WeighedSamples(block, seen, np.ones(natural.shape), 1.0)
        observation = weighted(seen, self.weightings)
        loss = weighting_loss(observation.map_baselines(), self._middle, Exponential())
        factors = observation.total_factors(block)
        return WeighedSamples(block, seen, factors, 1 / loss.variance_over_beam)

    @property
    def _middle(self) -> float:
        """Median scale length at the geometric mean of the limits of the flux [rad]."""
        limits = self.population.flux
        flux = math.sqrt(limits.minimum * limits.maximum)
        return float(self.population.size.median(np.array([flux]))[0])


@lru_cache(maxsize=3)
def _experiment(survey: MockSurvey) -> Experiment:
    faintest = survey.population.size.prior(np.array([survey.population.flux.minimum]))
    smallest = smallest_scale_length(float(faintest.log_median[0]), float(faintest.sigma[0]))
    return Experiment(
        beam=survey.facets.beam(survey.samples(), smallest),
        # Experiments have shears in the frame of the sky, in which the second component has the other sign.
        shears=tuple(shear.conjugate() for shear in survey.shears),
        population=survey.population,
        lens=survey.lens,
        size=survey.population.size,
        seed=survey.seed,
    )
