"""The survey that the benchmarks simulate: SKA-Mid AA4 for 8 h, galaxies of 10 to 200 uJy, 10 uJy at an SNR of 10."""

import math
import os
import time

import ducc0
import numpy as np

from uvshear.constants import ARCSEC, MICROJANSKY
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
from uvshear.predict.within_error import predict_within_error
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
    vis = predict_within_error(
        galaxies, baselines.uvw, FREQUENCY, 1e-5 * sigma, Exponential(), executor
    )
    noise = sigma * (rng.normal(size=vis.shape) + 1j * rng.normal(size=vis.shape))
    weights = np.full(vis.shape, sigma**-2, np.float32)

    def seen(data: np.ndarray) -> VisibilitySet:
        block = Visibilities(baselines.uvw, FREQUENCY, data.astype(np.complex64), weights)
        return VisibilitySet(PHASE_CENTRE, (block,))

    return galaxies, seen(vis + noise), seen(noise)


def cpu_seconds() -> float:
    """Processor time of this process and of those that have worked for it."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


def gridder_seconds() -> float:
    """Processor time of one pass of the w-gridder on one thread, the unit in which extractions are compared.

    It has 0.93 million rows, 2400^2 pixels of 0.15 arcsec and a relative error of 1e-4.
    """
    uvw = coverage(600.0).uvw
    found = []
    for _ in range(3):
        before = time.process_time()
        ducc0.wgridder.vis2dirty(
            uvw=uvw,
            freq=FREQUENCY,
            vis=np.ones((len(uvw), 1), np.complex64),
            wgt=np.ones((len(uvw), 1), np.float32),
            npix_x=2400,
            npix_y=2400,
            pixsize_x=0.15 * ARCSEC,
            pixsize_y=0.15 * ARCSEC,
            epsilon=1e-4,
            do_wgridding=True,
            nthreads=1,
        )
        found.append(time.process_time() - before)
    return float(np.median(found))
