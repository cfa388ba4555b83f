"""Simulation of the observation of a catalogue."""

import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from uvshear.constants import REFERENCE_FREQUENCY
from uvshear.errors import DataWarning
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile, SizeFluxRelation
from uvshear.geometry.directions import local_north
from uvshear.geometry.ellipticity import to_field_frame
from uvshear.interferometer.coverage import synthesise
from uvshear.interferometer.noise import Noise
from uvshear.interferometer.plan import ObservingPlan
from uvshear.io.catalogue import Catalogue
from uvshear.pipeline.catalogue import CatalogueLike, catalogue_of
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.noise_level import GalaxyNoise
from uvshear.simulation.observation import SimulatedObservation
from uvshear.typing import Array, Bool, Complex, Float

Lens: TypeAlias = Callable[[Galaxies, complex | Complex[Array, " source"]], Galaxies]
"""Effect of a reduced shear in the frame of (l, m) on galaxies."""


def simulate(
    catalogue: CatalogueLike,
    plan: ObservingPlan,
    *,
    noise: Noise | GalaxyNoise | None = None,
    shear: complex = 0j,
    lens: Lens = shear_galaxies,
    profile: Profile | None = None,
    seed: int | None = 1,
    executor: Executor = SERIAL,
    exact: bool = False,
) -> SimulatedObservation:
    """Simulate an observation of the sources of a catalogue.

    The result is an observation that can be measured directly; ``io.measurement_set.writer`` writes it to a
    Measurement Set.

    Parameters
    ----------
    catalogue
        Galaxies, or the file that has them; if it has shears of its own, they are applied. If it has no sizes, these
        are drawn from the size-flux relation, and galaxies without ellipticities are round.
    plan
        Array, track and channels of the observation.
    noise
        Noise that is set by an SEFD (``StokesINoise``, ``CorrelationNoise``), by its standard deviation
        (``ScaledNoise``), or by the signal-to-noise ratio of a galaxy (``GalaxyNoise``, the default, with a ratio of
        10 for a galaxy of 10 uJy and of median size).
    shear
        Reduced shear g1 + i g2 of all galaxies, in the frame of the sky (local North, TreeCorr's convention for RA
        and Dec), in addition to the catalogue's own.
    lens
        Effect of a shear on galaxies: ``shear_galaxies``, or ``shear_at_fixed_scale_length`` as in Rivi & Miller
        2018.
    seed
        Seed of the noise, and of sizes that the catalogue lacks; with None no noise is added, but the weights are those
        of the noise.
    exact
        Whether visibilities are summed over all galaxies in double precision. Otherwise this holds only without noise;
        with noise they have an rms error of at most 1e-5 of it, and most are computed from images.

    Warns
    -----
    DataWarning
        The catalogue lacks sizes of galaxies.
    """
    profile = profile or Exponential()
    sources = catalogue_of(catalogue)
    has_sizes = sources.scale_length is not None
    without_size = _galaxies_without_size(sources)
    if without_size.any():
        drawn = _drawn_sizes(sources, seed)
        known = np.zeros(len(sources)) if sources.scale_length is None else sources.scale_length
        sources = replace(sources, scale_length=np.where(without_size, drawn, known))
    galaxies = sources.galaxies(plan.track.phase_centre)
    north = local_north(plan.track.phase_centre, galaxies.l, galaxies.m)
    for sky_shear in (sources.shear, shear):
        if sky_shear is not None and np.any(sky_shear):
            galaxies = lens(
                galaxies, to_field_frame(sky_shear + np.zeros(len(galaxies), complex), north)
            )
    coverage = synthesise(plan.layout, plan.track)
    noise = noise or GalaxyNoise()
    if isinstance(noise, GalaxyNoise):
        noise = noise.scaled_to(coverage, plan.channels, profile, executor)
    # What is wrong is said before.
    if without_size.any():
        count = np.count_nonzero(without_size)
        lacks = (
            f"no scale_length for {count} of its {len(sources)} sources"
            if has_sizes
            else "no column scale_length"
        )
        warnings.warn(
            f"the catalogue has {lacks}: the sizes of its galaxies are drawn from the size-flux relation",
            DataWarning,
            stacklevel=2,
        )
    return SimulatedObservation(
        coverage=coverage,
        channels=plan.channels,
        galaxies=galaxies,
        profile=profile,
        noise=noise,
        seed=seed,
        executor=executor,
        is_averaged=plan.is_averaged,
        primary_beam=plan.primary_beam,
        is_exact=exact,
    )


def _galaxies_without_size(sources: Catalogue) -> Bool[Array, " source"]:
    unknown = np.ones(len(sources), bool)
    if sources.scale_length is not None:
        unknown = np.isnan(sources.scale_length)
    return unknown if sources.is_point is None else unknown & ~sources.is_point


def _drawn_sizes(sources: Catalogue, seed: int | None) -> Float[Array, " source"]:
    ratio = REFERENCE_FREQUENCY / sources.reference_frequency
    rng = np.random.default_rng([0 if seed is None else seed, len(sources)])
    return SizeFluxRelation().draw(sources.flux * ratio**sources.spectral_index, rng)
