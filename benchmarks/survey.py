"""The survey that the benchmarks simulate: SKA-Mid AA4 for 8 h, galaxies of 10 to 200 uJy, 10 uJy at an SNR of 10."""

import math

import numpy as np

from uvshear.constants import MICROJANSKY
from uvshear.execution import Executor
from uvshear.galaxy import (
    DiscEllipticityPrior,
    Exponential,
    Galaxies,
    PowerLawFlux,
    SizeFluxRelation,
)
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.coverage import Coverage, Track, synthesise
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import Visibilities, VisibilitySet
from uvshear.predict import predict_visibilities
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SkyRegion, SquareField

CHANNELS = Channels.from_band(0.95e9, 1.19e9, 1)
FREQUENCY = CHANNELS.frequency
PHASE_CENTRE = PhaseCentre(0.3, math.radians(-30))


def draw(field: SkyRegion, number: int, rng: np.random.Generator) -> Galaxies:
    """Galaxies of the paper's fluxes, sizes and ellipticities."""
    population = Population(
        PowerLawFlux(minimum=10 * MICROJANSKY, maximum=200 * MICROJANSKY),
        SizeFluxRelation(),
        DiscEllipticityPrior(),
    )
    return draw_population(population, field, number=number, rng=rng)


def coverage(integration: float) -> Coverage:
    """Baselines of the 8 h, in integrations of so many seconds."""
    track = Track.from_clock(PHASE_CENTRE, ((-14400.0, 14400.0),), integration)
    return synthesise(load_layout("ska-mid-aa4"), track)


def simulate(
    arcmin: float, density: float, integration: float, seed: int, executor: Executor
) -> tuple[Galaxies, VisibilitySet, VisibilitySet]:
    """Square field of galaxies with noise, and the noise alone; ``density`` is per square arcminute."""
    rng = np.random.default_rng(seed)
    field = SquareField(math.radians(arcmin / 60))
    galaxies = draw(field, round(density * arcmin**2), rng)
    baselines = coverage(integration)
    level = GalaxyNoise().scaled_to(baselines, CHANNELS, Exponential(), executor)
    sigma = level.stokes_i_sigma
    vis = predict_visibilities(galaxies, baselines.uvw, FREQUENCY, Exponential(), executor)
    noise = sigma * (rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape))
    weights = np.full(vis.shape, sigma**-2, np.float32)

    def seen(data: np.ndarray) -> VisibilitySet:
        block = Visibilities(baselines.uvw, FREQUENCY, data.astype(np.complex64), weights)
        return VisibilitySet(PHASE_CENTRE, (block,))

    return galaxies, seen(vis + noise), seen(noise)
