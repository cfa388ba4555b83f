"""Bias of an estimator for isolated galaxies with known shears."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from uvshear.bias.fit import TermSums, fit_bias, shears_from_sums
from uvshear.bias.mock_facets import FacetBeam, FacetNoise
from uvshear.bias.realisations import OPPOSITE, TURNED, Realisation
from uvshear.errors import InputError
from uvshear.estimators import Bias, Estimator, Sample
from uvshear.estimators.estimate import sky_terms, within_reach
from uvshear.estimators.estimator import observe
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.estimators.sample import Row
from uvshear.execution import SERIAL, Executor, single_threaded_libraries
from uvshear.galaxy import (
    DiscEllipticityPrior,
    EllipticityPrior,
    Exponential,
    Galaxies,
    Profile,
    SizeFluxRelation,
)
from uvshear.progress import Meter, Progress, Stage
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import fit_galaxy
from uvshear.shapes.source_facet import SourceFacet
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.population import Population
from uvshear.typing import Array, Complex, Float

BLOCK = 50
"""Number of galaxies in a task, whose sums form one block of the jackknife."""

PILOT, FEWEST, PILOT_ROUNDS = 500, 100, 2
"""First guess of the shear about which an estimator is expanded: the number of galaxies that are drawn for it, the
smallest number that must pass a cut by flux, and the number of iterations."""

TRAINING = 1500
"""Number of galaxies to which an estimator fits its population."""

FITTED = Exponential()
"""Profile of the fits and of the cut by signal-to-noise ratio, whatever the true profile."""


@dataclass(frozen=True)
class Experiment:
    """A population of isolated galaxies, their shears, and the cuts that select them.

    Parameters
    ----------
    beam
        Beam of the observation, from which facets are drawn.
    shears
        Reduced shears in the frame of the sky, which add up to zero. With a single zero only the additive bias is
        estimated.
    population
        Distributions of flux, size and ellipticity.
    profile
        True brightness profile.
    lens
        Map of galaxies by a shear.
    size
        Size-flux relation that gives the prior on the size.
    snr_min
        Signal-to-noise ratio below which galaxies are left out, computed from the catalogue's flux and the median size,
        so that shear does not move galaxies across the cut.
    measured_snr_min
        Signal-to-noise ratio of the best fit below which a measurement is left out. Shear and noise move galaxies
        across that cut.
    flux_min, flux_max
        Catalogue fluxes below and above which galaxies are left out [Jy].
    position_sigma
        Standard error of the catalogue's positions in l and in m [rad].
    has_rings
        Whether galaxies are simulated with e and -e. Without these pairs a non-linear estimator has nearly the same
        error of m at half the cost, but a large error of c.
    weights_population
        Distribution of ellipticities on which the weights of shapes depend.
    seed
        Seed of galaxies and noise.
    """

    beam: FacetBeam
    shears: tuple[complex, ...]
    population: Population = field(default_factory=Population)
    profile: Profile = field(default_factory=Exponential)
    lens: Callable[[Galaxies, complex], Galaxies] = shear_galaxies
    size: SizeFluxRelation = field(default_factory=SizeFluxRelation)
    snr_min: float = 0.0
    measured_snr_min: float = 0.0
    flux_min: float = 0.0
    flux_max: float = math.inf
    position_sigma: float = 0.0
    has_rings: bool = True
    weights_population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)
    seed: int = 1

    def __post_init__(self) -> None:
        if abs(sum(self.shears)) > 1e-9:
            raise InputError("the shears of a simulated bias must add up to zero; these do not")

    @property
    def realisations(self) -> tuple[Realisation, ...]:
        """Realisations of each galaxy with each shear."""
        if not any(self.shears):
            return TURNED
        return OPPOSITE if self.has_rings else OPPOSITE[:2]

    def draw(self, number: int, rng: np.random.Generator) -> Galaxies:
        """Draw galaxies of the population, all of them at the phase centre up to the error of their position."""
        population = self.population
        flux = population.flux.draw(number, rng)
        modulus = population.ellipticity.draw_modulus(number, rng)
        turn = np.exp(2j * np.pi * rng.uniform(size=number))
        return Galaxies(
            l=self.position_sigma * rng.standard_normal(number),
            m=self.position_sigma * rng.standard_normal(number),
            flux=flux,
            scale_length=population.size.draw(flux, rng),
            ellipticity=modulus * turn,
            spectral_index=np.full(number, population.spectral_index),
        )


@dataclass(frozen=True)
class MockGalaxy:
    """One realisation of a galaxy behind one shear.

    Parameters
    ----------
    number
        Number of the galaxy in its task.
    shear
        Index of the shear among those of the experiment.
    source
        Facet of the galaxy, as it is passed to an estimator.
    true
        The galaxy behind the shear.
    """

    number: int
    shear: int
    source: SourceFacet
    true: GalaxyFit


def estimate_isolated_bias(
    experiment: Experiment,
    estimator: Estimator,
    galaxies: int,
    executor: Executor = SERIAL,
    progress: Progress | None = None,
) -> Bias:
    """Estimate the bias of an estimator, in total and by flux; the result does not depend on the executor."""
    shears = experiment.shears
    about: Sequence[complex] = [0j] * len(shears)
    # Without a shear the estimate is nearly zero, so that the expansion is about zero.
    is_piloted = estimator.is_expanded and any(shears)
    pilot = min(_pilot(experiment), galaxies) if is_piloted else 0
    meter = Meter(progress)
    first = Stage("first guess", PILOT_ROUNDS * pilot, PILOT_ROUNDS * pilot, "galaxies")
    main = Stage("galaxies", galaxies, galaxies, "galaxies")
    if estimator.is_learning:
        meter.begin(Stage("population"), first, main)
        estimator = _trained(experiment, estimator, galaxies)
    if pilot:
        meter.begin(first, main)
    for _ in range(PILOT_ROUNDS if pilot else 0):
        sums = _run((experiment, estimator, about), pilot, executor, meter)
        found = shears_from_sums(sum(block.values.sum(axis=0) for block in sums), about)
        about = [within_reach(complex(*pair)) for pair in found]
    meter.begin(main)
    blocks = _run((experiment, estimator, about), galaxies, executor, meter)
    values = np.array([block.values for block in blocks])
    count = np.array([block.count for block in blocks]).sum(axis=0).astype(int)
    failed = np.array([block.failed for block in blocks]).sum(axis=0).astype(int)
    total = TermSums(values.sum(axis=1), int(count.sum()), int(failed.sum()))
    bins = {
        flux_bin.name: TermSums(values[:, k], int(count[k]), int(failed[k]))
        for k, flux_bin in enumerate(FLUX_BINS)
    }
    return fit_bias(total, bins, shears, about)


def _trained(experiment: Experiment, estimator: Estimator, galaxies: int) -> Estimator:
    """Return the estimator trained on unsheared galaxies other than those that are measured."""
    if not estimator.is_learning:
        return estimator
    unlensed = replace(experiment, shears=(0j,))
    mocks = mock_galaxies(unlensed, galaxies, TRAINING, unlensed.realisations[:1])
    found = (observe(estimator.learner, mock.source) for mock in mocks)
    rows = [row for row in found if row is not None]
    if not rows:
        raise InputError(
            "no galaxy passes the cuts, so that no population can be fitted; relax the cuts"
        )
    return estimator.trained(Sample.from_rows(rows), 0j)


def _pilot(experiment: Experiment) -> int:
    """Return the number of galaxies to draw for a first guess of the shear."""
    flux = experiment.population.flux.draw(10_000, np.random.default_rng(experiment.seed))
    passing = np.mean((flux >= experiment.flux_min) & (flux <= experiment.flux_max))
    return max(PILOT, math.ceil(FEWEST / max(float(passing), 1e-3)))


@dataclass(frozen=True)
class BlockSums:
    """Sums of an estimator's terms over the galaxies of a task, by bin of flux; the last bin holds all other fluxes.

    Parameters
    ----------
    values
        Two numbers and four of their response.
    count
        Number of galaxies that contribute.
    failed
        Number of measurements that failed.
    """

    values: Float[Array, "bin shear 6"]
    count: Float[Array, " bin"]
    failed: Float[Array, " bin"]


_Setting: TypeAlias = tuple[Experiment, Estimator, Sequence[complex]]


def _run(setting: _Setting, galaxies: int, executor: Executor, meter: Meter) -> list[BlockSums]:
    tasks = [(first, min(BLOCK, galaxies - first)) for first in range(0, galaxies, BLOCK)]
    done: list[BlockSums] = []
    with single_threaded_libraries():
        for (_, number), sums in zip(
            tasks, executor.distribute(_sums_of_task, setting, tasks), strict=True
        ):
            done.append(sums)
            meter.add(number)
    return done


def _sums_of_task(setting: _Setting, task: tuple[int, int]) -> BlockSums:
    return sum_terms(*setting, *task)


def sum_terms(
    experiment: Experiment,
    estimator: Estimator,
    about: Sequence[complex],
    first: int,
    number: int,
) -> BlockSums:
    """Draw galaxies from number ``first`` on, and sum the estimator's terms of each galaxy with every shear.

    Parameters
    ----------
    about
        Shears about which the terms are expanded, one for each shear of the experiment.
    first, number
        Number of the first galaxy, and number of galaxies.
    """
    bins = len(FLUX_BINS) + 1
    values, failed = np.zeros((bins, len(about), 6)), np.zeros(bins)
    members: list[set[int]] = [set() for _ in range(bins)]
    seen: list[list[tuple[int, int, Row]]] = [[] for _ in about]
    for mock in mock_galaxies(experiment, first, number):
        if experiment.measured_snr_min > 0 and not _is_bright(mock, experiment.measured_snr_min):
            continue
        place = _bin_of(mock.source.flux)
        row = observe(estimator, mock.source)
        if row is None:
            failed[place] += 1
        else:
            # The facet, which may have megabytes, is not held.
            seen[mock.shear].append((mock.number, place, row))
    for shear, found in enumerate(seen):
        if not found:
            continue
        sample = Sample.from_rows([row for _, _, row in found])
        terms = sky_terms(estimator, sample, about[shear])
        for k, (galaxy, place, _) in enumerate(found):
            if not np.isfinite(terms.value[k]).all():
                failed[place] += 1
            elif terms.response[k].any():
                members[place].add(galaxy)
                values[place, shear] += np.concatenate([terms.value[k], terms.response[k].ravel()])
    return BlockSums(values, np.array([float(len(galaxies)) for galaxies in members]), failed)


def _bin_of(flux: float) -> int:
    fluxes = np.array([flux])
    inside = (k for k, flux_bin in enumerate(FLUX_BINS) if flux_bin.holds(fluxes))
    return next(inside, len(FLUX_BINS))


def _is_bright(mock: MockGalaxy, snr_min: float) -> bool:
    fit = fit_galaxy(mock.source.facet, mock.source.prior, FITTED)
    return fit is not None and fit.snr >= snr_min


def mock_galaxies(
    experiment: Experiment,
    first: int,
    number: int,
    realisations: Sequence[Realisation] | None = None,
) -> Iterator[MockGalaxy]:
    """Draw galaxies from number ``first`` on, and yield every realisation of each galaxy with every shear.

    Parameters
    ----------
    realisations
        Realisations that are drawn; those of the experiment unless given.
    """
    rng = np.random.default_rng([experiment.seed, first])
    more_rng = np.random.default_rng([experiment.seed, first, 1])
    galaxies = experiment.draw(number, rng)
    size = experiment.size.prior(galaxies.flux)
    # At the phase centre the frames of (l, m) and of the sky differ by the sign of the second component.
    shears = [complex(shear).conjugate() for shear in experiment.shears]
    lensed = [
        ([experiment.lens(part.galaxies(galaxies), g) for g in shears], part.noise)
        for part in realisations or experiment.realisations
    ]
    for k in range(number):
        prior = ShapePrior(float(size.log_median[k]), float(size.sigma[k]))
        simulator = experiment.beam.simulator(prior.log_scale_length, prior.log_scale_length_sigma)
        noise, more = simulator.draw_noise(rng), simulator.draw_noise(more_rng)
        flux = float(galaxies.flux[k])
        is_bright = flux * simulator.snr_of_jansky(prior, FITTED) >= experiment.snr_min
        if not is_bright or not experiment.flux_min <= flux <= experiment.flux_max:
            continue
        for column in range(len(shears)):
            for behind, altered in lensed:
                galaxy = _galaxy(behind[column], k)
                facet = simulator.facet(galaxy, experiment.profile, altered(simulator, noise))
                source = SourceFacet(
                    facet=facet,
                    cells=simulator.cutout,
                    prior=prior,
                    flux=flux,
                    profile=FITTED,
                    population=experiment.weights_population,
                    draw_noise=_given(altered(simulator, more)),
                )
                yield MockGalaxy(k, column, source, galaxy)


def _given(noise: FacetNoise) -> Callable[[int], Complex[Array, " cell"]]:
    """Return a function that gives this noise, the noise of the realisation, whatever the seed."""

    def draw(seed: int) -> Complex[Array, " cell"]:
        del seed
        return noise

    return draw


def _galaxy(galaxies: Galaxies, k: int) -> GalaxyFit:
    return GalaxyFit(
        float(galaxies.flux[k]),
        np.array([galaxies.l[k], galaxies.m[k]]),
        complex(galaxies.ellipticity[k]),
        float(galaxies.scale_length[k]),
        0.0,
    )
