"""Multiplicative and additive bias of an estimator from simulated galaxies.

The same galaxies behind opposite shears, with the same noise: their difference is free of most of both. Each galaxy
is there with e and with -e, and with its noise and the opposite: the intrinsic shapes and the noise cancel in the sum,
which shows the additive bias.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np
from threadpoolctl import threadpool_limits

from uvshear.calibration.estimators import Estimator, Seen
from uvshear.calibration.isolated import Beam
from uvshear.fit.measurement import GalaxyFit
from uvshear.fit.prior import ShapePrior
from uvshear.galaxy import Galaxies, Profile, SizeFluxRelation
from uvshear.shear.response import jackknife
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.population import Population
from uvshear.typing import Array, Float

BLOCK = 50
"""Galaxies to a task; their sums are a block of the jackknife."""

_VALUES = 6


@dataclass(frozen=True)
class Experiment:
    """What is simulated.

    Parameters
    ----------
    beam
        Of the observation.
    population
        Fluxes, sizes and ellipticities.
    profile
        True brightness profile.
    shears
        Reduced shears, together symmetric about 0.
    lens
        What a shear does to galaxies.
    size
        Relation that the estimator takes its prior of the size from.
    flux_bins
        Edges [Jy].
    seed
        Of galaxies and noise.
    """

    beam: Beam
    population: Population
    profile: Profile
    shears: tuple[complex, ...]
    flux_bins: tuple[float, ...]
    lens: Callable[[Galaxies, complex], Galaxies] = shear_galaxies
    size: SizeFluxRelation = SizeFluxRelation()
    seed: int = 1

    def draw(self, first: int, number: int) -> tuple[Galaxies, np.random.Generator]:
        """Draw galaxies ``first`` to ``first + number``, and the stream of their noise."""
        rng = np.random.default_rng([self.seed, first])
        population = self.population
        flux = population.flux.draw(number, rng)
        modulus = population.ellipticity.draw_modulus(number, rng)
        turn = np.exp(2j * np.pi * rng.uniform(size=number))
        galaxies = Galaxies(
            l=np.zeros(number),
            m=np.zeros(number),
            flux=flux,
            scale_length=population.size.draw(flux, rng),
            ellipticity=modulus * turn,
            spectral_index=np.full(number, population.spectral_index),
        )
        return galaxies, rng


@dataclass(frozen=True)
class Sums:
    """Sums over the galaxies of a block: of values and responses, and their number, by flux bin and shear."""

    values: Float[Array, "bin shear 6"]
    count: Float[Array, "bin shear"]
    failed: int


def sums_of(experiment: Experiment, estimator: Estimator, first: int, number: int) -> Sums:
    """Draw galaxies, and let the estimator look at each behind every shear."""
    galaxies, rng = experiment.draw(first, number)
    bins, shears = len(experiment.flux_bins) - 1, len(experiment.shears)
    values, count, failed = np.zeros((bins, shears, _VALUES)), np.zeros((bins, shears)), 0
    size = experiment.size.prior(galaxies.flux)
    which = np.searchsorted(experiment.flux_bins, galaxies.flux, side="right") - 1
    turned = galaxies_turned(galaxies)
    lensed = [[experiment.lens(one, shear) for shear in experiment.shears] for one in turned]
    for k in range(number):
        stage = experiment.beam.stage(float(size.log_median[k]), float(size.sigma[k]))
        noise = stage.noise(rng)
        prior = ShapePrior(float(size.log_median[k]), float(size.sigma[k]))
        row = int(which[k])
        if not 0 <= row < bins:
            continue
        for one in lensed:
            for column, sky in enumerate(one):
                galaxy = GalaxyFit(
                    float(sky.flux[k]),
                    np.zeros(2),
                    complex(sky.ellipticity[k]),
                    float(sky.scale_length[k]),
                    0.0,
                )
                for sign in (1, -1):
                    facet = stage.facet(galaxy, experiment.profile, sign * noise)
                    term = estimator.term(Seen(facet, stage, prior, float(galaxies.flux[k])))
                    if term is None:
                        failed += 1
                        continue
                    values[row, column, :2] += term[0]
                    values[row, column, 2:] += term[1].ravel()
                    count[row, column] += 1
    return Sums(values, count, failed)


def galaxies_turned(galaxies: Galaxies) -> tuple[Galaxies, Galaxies]:
    """Galaxies and the same turned by a right angle."""
    from dataclasses import replace

    return galaxies, replace(galaxies, ellipticity=-galaxies.ellipticity)
