"""Galaxies alone in the beam behind known shears, and what an estimator makes of them."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import TypeAlias

import numpy as np

from uvshear.bias.cell_average import CellAverageBeam
from uvshear.bias.fit import Bias, TermSums, fit_bias, shears_from_sums
from uvshear.bias.mock_facets import FacetNoise, MockBeam
from uvshear.bias.realisations import OPPOSITE, TURNED, Realisation
from uvshear.errors import InputError
from uvshear.estimators import Estimator, Sample
from uvshear.estimators.estimate import sky_terms, within_reach
from uvshear.estimators.estimator import observe
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.execution import SERIAL, Executor, single_threaded_libraries
from uvshear.galaxy import (
    DiscEllipticityPrior,
    EllipticityPrior,
    Exponential,
    Galaxies,
    Profile,
    SizeFluxRelation,
)
from uvshear.progress import Meter, Progress
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import fit_galaxy
from uvshear.shapes.source_facet import SourceFacet
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.population import Population
from uvshear.typing import Array, Complex, Float

BLOCK = 50
"""Galaxies of a task, whose sums are a block of the jackknife."""

PILOT, FEWEST, PILOT_ROUNDS = 500, 100, 2
"""Galaxies that are drawn, galaxies that a cut by flux leaves of them at least, and rounds, for the first guess of the
shear about which an estimator is expanded."""

TRAINING = 1500
"""Galaxies from which an estimator learns its population."""

FITTED = Exponential()
"""Profile that is fitted, and that the cut by signal-to-noise ratio takes, whatever the true one."""


@dataclass(frozen=True)
class Experiment:
    """What is simulated.

    Parameters
    ----------
    beam
        Beam of the observation.
    shears
        Reduced shears in the frame of the sky, which add up to zero; a single zero leaves the additive bias alone.
    population
        Distributions of flux, size and ellipticity.
    profile
        True brightness profile.
    lens
        What a shear does to galaxies.
    size
        Relation from which the estimator takes its prior of the size.
    snr_min
        Signal-to-noise ratio, by the catalogue's flux and the median size, below which galaxies are left out: no shear
        changes that cut.
    measured_snr_min
        Signal-to-noise ratio of the best fit below which a measurement is left out: shear and noise have a say in it.
    flux_min, flux_max
        Catalogue's fluxes below and above which galaxies are left out [Jy].
    position_sigma
        Standard error of the catalogue's positions in l and in m [rad].
    has_rings
        Whether galaxies are seen with e and -e. An estimator that is not linear has nearly the same error of m
        without, at half the cost, but a large one of c.
    weights_population
        Distribution of ellipticities that the weights of shapes are made for.
    seed
        Seed of galaxies and noise.
    """

    beam: MockBeam | CellAverageBeam
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
            raise InputError("the shears of a simulated bias add up to zero; these do not")

    @property
    def realisations(self) -> tuple[Realisation, ...]:
        """How often, and in what way, each galaxy is seen behind each shear."""
        if not any(self.shears):
            return TURNED
        return OPPOSITE if self.has_rings else OPPOSITE[:2]

    def draw(self, number: int, rng: np.random.Generator) -> Galaxies:
        """Draw galaxies of the population in one place."""
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
    """A facet of one galaxy behind one shear.

    Parameters
    ----------
    number
        Number of the galaxy in its task.
    shear
        Place of the shear among those of the experiment.
    source
        The galaxy as an estimator sees it.
    """

    number: int
    shear: int
    source: SourceFacet


def estimate_isolated_bias(
    experiment: Experiment,
    estimator: Estimator,
    galaxies: int,
    executor: Executor = SERIAL,
    progress: Progress | None = None,
) -> Bias:
    """Bias of an estimator in total and by flux; the same whatever the executor."""
    shears = experiment.shears
    about: Sequence[complex] = [0j] * len(shears)
    # Without a shear the estimate is next to none: that is where it is expanded.
    is_piloted = estimator.is_expanded and any(shears)
    pilot = min(_pilot(experiment), galaxies) if is_piloted else 0
    meter = Meter(progress)
    meter.expect(galaxies + PILOT_ROUNDS * pilot)
    estimator = _trained(experiment, estimator, galaxies)
    for _ in range(PILOT_ROUNDS if pilot else 0):
        sums = _run((experiment, estimator, about), pilot, executor, meter)
        found = shears_from_sums(sum(block.values.sum(axis=0) for block in sums), about)
        about = [within_reach(complex(*pair)) for pair in found]
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
    """Let the estimator learn from galaxies without a shear, as a survey has them; not those that are measured."""
    if not estimator.is_learning:
        return estimator
    unlensed = mock_galaxies(replace(experiment, shears=(0j,)), galaxies, TRAINING)
    # The first of the realisations of each galaxy.
    sources = (mock.source for mock in islice(unlensed, 0, None, len(TURNED)))
    rows = [row for source in sources if (row := observe(estimator.learner, source)) is not None]
    if not rows:
        raise InputError("no galaxy passes the cuts; the estimator needs some to learn from")
    return estimator.trained(Sample.from_rows(rows), 0j)


def _pilot(experiment: Experiment) -> int:
    """Count the galaxies that are drawn for a first guess."""
    flux = experiment.population.flux.draw(10_000, np.random.default_rng(experiment.seed))
    passing = np.mean((flux >= experiment.flux_min) & (flux <= experiment.flux_max))
    return max(PILOT, math.ceil(FEWEST / max(float(passing), 1e-3)))


@dataclass(frozen=True)
class BlockSums:
    """Sums of an estimator's terms over the galaxies of a task, by bin of flux; the last bin is of all other fluxes.

    Parameters
    ----------
    values
        Two numbers and four of their response.
    count
        Number of galaxies that tell something.
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
    """Draw galaxies ``first`` and on; add up the estimator's terms of each behind every shear, expanded ``about`` it."""
    bins = len(FLUX_BINS) + 1
    values, failed = np.zeros((bins, len(about), 6)), np.zeros(bins)
    members: list[set[int]] = [set() for _ in range(bins)]
    rows: list[list[_Row]] = [[] for _ in about]
    for mock in mock_galaxies(experiment, first, number):
        if experiment.measured_snr_min > 0 and not _is_bright(mock, experiment.measured_snr_min):
            continue
        row = observe(estimator, mock.source)
        if row is None:
            failed[_bin_of(mock.source.flux)] += 1
        else:
            rows[mock.shear].append((mock.number, row))
    for shear, seen in enumerate(rows):
        if not seen:
            continue
        sample = Sample.from_rows([row for _, row in seen])
        terms = sky_terms(estimator, sample, about[shear])
        for k, (galaxy, row) in enumerate(seen):
            place = _bin_of(float(row["flux"]))
            if not np.isfinite(terms.value[k]).all():
                failed[place] += 1
            elif terms.response[k].any():
                members[place].add(galaxy)
                values[place, shear] += np.concatenate([terms.value[k], terms.response[k].ravel()])
    return BlockSums(values, np.array([float(len(galaxies)) for galaxies in members]), failed)


_Row: TypeAlias = tuple[int, dict[str, float | Array]]
"""Number of a galaxy, and its row of a sample."""


def _bin_of(flux: float) -> int:
    fluxes = np.array([flux])
    inside = (k for k, flux_bin in enumerate(FLUX_BINS) if flux_bin.holds(fluxes))
    return next(inside, len(FLUX_BINS))


def _is_bright(mock: MockGalaxy, snr_min: float) -> bool:
    fit = fit_galaxy(mock.source.facet, mock.source.prior, FITTED)
    return fit is not None and fit.snr >= snr_min


def mock_galaxies(experiment: Experiment, first: int, number: int) -> Iterator[MockGalaxy]:
    """Draw galaxies ``first`` and on, and yield each behind every shear in every realisation."""
    rng = np.random.default_rng([experiment.seed, first])
    more_rng = np.random.default_rng([experiment.seed, first, 1])
    galaxies = experiment.draw(number, rng)
    size = experiment.size.prior(galaxies.flux)
    # At the phase centre the frame of (l, m) is that of the sky but for the sign of the second component.
    shears = [complex(shear).conjugate() for shear in experiment.shears]
    lensed = [
        ([experiment.lens(part.galaxies(galaxies), g) for g in shears], part.noise)
        for part in experiment.realisations
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
                yield MockGalaxy(k, column, source)


def _given(noise: FacetNoise) -> Callable[[int], Complex[Array, " cell"]]:
    """Return what draws this noise, whatever the seed: it goes with the realisation."""

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
