"""Isolated galaxies behind known shears, and what an estimator makes of them."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

import numpy as np

from uvshear.bias.bias import LEAST_BLOCKS, Bias, fit_bias, is_told, shears_of
from uvshear.bias.cell_average import CellAverageBeam
from uvshear.bias.estimators import Estimator, Seen
from uvshear.bias.isolated import Beam, Noise, Stage
from uvshear.errors import InputError
from uvshear.estimators.estimator import within_reach
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.execution import SERIAL, Executor
from uvshear.galaxy import Exponential, Galaxies, Profile, SizeFluxRelation
from uvshear.progress import Meter, Progress
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.simulation.lensing import shear_galaxies
from uvshear.simulation.population import Population
from uvshear.typing import Array, Float

BLOCK = 50
"""Galaxies to a task; their sums are a block of the jackknife."""

PILOT, FEWEST, PILOT_ROUNDS = 500, 100, 2
"""Galaxies drawn, those of them that a cut by flux leaves at least, and rounds that an expanded estimator's first guess
of the shear takes."""

PUPILS = 1500
"""Galaxies that an estimator learns its population from."""

FITTED = Exponential()
"""Profile that the cut by signal-to-noise ratio takes, whatever the true one."""


@dataclass(frozen=True)
class Take:
    """A look at galaxies: what is done to them before they are lensed, and to their noise."""

    galaxies: Callable[[Galaxies], Galaxies]
    noise: Callable[[Stage, Noise], Noise]


def _as_drawn(galaxies: Galaxies) -> Galaxies:
    return galaxies


def _crossed(galaxies: Galaxies) -> Galaxies:
    return replace(galaxies, ellipticity=-galaxies.ellipticity)


def _turned(galaxies: Galaxies) -> Galaxies:
    return replace(galaxies, l=-galaxies.m, m=galaxies.l, ellipticity=-galaxies.ellipticity)


def _same(stage: Stage, noise: Noise) -> Noise:
    return noise


def _negative(stage: Stage, noise: Noise) -> Noise:
    return -noise


OPPOSITE = tuple(
    Take(shape, noise) for shape in (_as_drawn, _crossed) for noise in (_same, _negative)
)
"""Ellipticities of both signs with noise of both signs: what is odd in either cancels."""


def _turn(take: Take) -> Take:
    return Take(
        lambda galaxies: _turned(take.galaxies(galaxies)),
        lambda stage, noise: stage.turned(take.noise(stage, noise)),
    )


TURNED = (*OPPOSITE, *(_turn(take) for take in OPPOSITE))
"""And all of it, the noise too, turned by a right angle: without shear nothing is left but what the beam's own
direction does. One galaxy tells as much of the additive bias as a hundred of the others."""


@dataclass(frozen=True)
class Experiment:
    """What is simulated.

    Parameters
    ----------
    beam
        Of the observation.
    shears
        Reduced shears that add up to zero; a single zero leaves the additive bias alone.
    population
        Fluxes, sizes and ellipticities.
    profile
        True brightness profile.
    lens
        What a shear does to galaxies.
    size
        Relation that the estimator takes its prior of the size from.
    snr_min
        Galaxies whose catalogue flux makes for less, at the median size, are left out: no shear changes that.
    flux_min, flux_max
        Catalogue fluxes below and above which galaxies are left out [Jy].
    position_sigma
        Errors of the catalogue's position, in l and in m [rad].
    has_rings
        Whether galaxies are seen with e and -e. An estimator that is not linear has nearly the same error of m
        without, at half the cost, but a large one of c.
    seed
        Of galaxies and noise.
    """

    beam: Beam | CellAverageBeam
    shears: tuple[complex, ...]
    population: Population = field(default_factory=Population)
    profile: Profile = field(default_factory=Exponential)
    lens: Callable[[Galaxies, complex], Galaxies] = shear_galaxies
    size: SizeFluxRelation = field(default_factory=SizeFluxRelation)
    snr_min: float = 0.0
    flux_min: float = 0.0
    flux_max: float = math.inf
    position_sigma: float = 0.0
    has_rings: bool = True
    seed: int = 1

    def __post_init__(self) -> None:
        if abs(sum(self.shears)) > 1e-9:
            raise InputError("a calibration's shears add up to zero")

    @property
    def takes(self) -> tuple[Take, ...]:
        """How often, and how, each galaxy is seen behind each shear."""
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
class Sums:
    """Sums of an estimator's numbers over the galaxies of a block, how many tell something, and failed measurements."""

    values: Float[Array, "bin shear 6"]
    count: Float[Array, " bin"]
    failed: Float[Array, " bin"]


def calibrate(
    experiment: Experiment,
    estimator: Estimator,
    galaxies: int,
    executor: Executor = SERIAL,
    progress: Progress | None = None,
) -> list[Bias]:
    """Bias of an estimator in total and by flux; the same whatever the number of processes."""
    about: Sequence[complex] = [0j] * len(experiment.shears)
    # Without a shear the estimate is next to none: that is where it is expanded.
    is_piloted = estimator.is_expanded and any(experiment.shears)
    pilot = min(_pilot(experiment), galaxies) if is_piloted else 0
    meter = Meter(progress)
    meter.expect(galaxies + PILOT_ROUNDS * pilot)
    if estimator.is_learning:
        # Without shear, each once, as a survey has them; not those that are measured.
        every = looks(replace(experiment, shears=(0j,)), [0j], galaxies, PUPILS)
        estimator = estimator.learned([seen for _, _, seen in islice(every, 0, None, len(TURNED))])
    for _ in range(PILOT_ROUNDS if pilot else 0):
        sums = _run(experiment, estimator, about, pilot, executor, meter)
        found = shears_of(sum(one.values.sum(axis=0) for one in sums), about)
        about = [within_reach(complex(*pair)) for pair in found]
    blocks = _run(experiment, estimator, about, galaxies, executor, meter)
    values = np.array([block.values for block in blocks])
    count = np.array([block.count for block in blocks]).sum(axis=0)
    shears = experiment.shears
    failed = np.array([block.failed for block in blocks]).sum(axis=0)
    named = [("all", values.sum(axis=1), int(count.sum()), int(failed.sum()))]
    for k, one in enumerate(FLUX_BINS):
        named.append((one.name, values[:, k], int(count[k]), int(failed[k])))
    total, *bins = named
    told = [one for one in bins if is_told(one[1]).sum() >= LEAST_BLOCKS]
    return [fit_bias(name, shears, about, part, n, bad) for name, part, n, bad in (total, *told)]


def _pilot(experiment: Experiment) -> int:
    """How many galaxies are drawn for a first guess."""
    flux = experiment.population.flux.draw(10_000, np.random.default_rng(experiment.seed))
    passing = np.mean((flux >= experiment.flux_min) & (flux <= experiment.flux_max))
    return max(PILOT, math.ceil(FEWEST / max(float(passing), 1e-3)))


def _run(
    experiment: Experiment,
    estimator: Estimator,
    about: Sequence[complex],
    galaxies: int,
    executor: Executor,
    meter: Meter,
) -> list[Sums]:
    tasks = [(first, min(BLOCK, galaxies - first)) for first in range(0, galaxies, BLOCK)]
    done: list[Sums] = []
    for (_, number), sums in zip(
        tasks, executor.distribute(_work, (experiment, estimator, about), tasks), strict=True
    ):
        done.append(sums)
        meter.add(number)
    return done


_Setting = tuple[Experiment, Estimator, Sequence[complex]]


def _work(setting: _Setting, task: tuple[int, int]) -> Sums:
    return sums_of(*setting, *task)


def sums_of(
    experiment: Experiment,
    estimator: Estimator,
    about: Sequence[complex],
    first: int,
    number: int,
) -> Sums:
    """Draw galaxies ``first`` and on; let the estimator see each behind every shear, expanded ``about`` it."""
    # One row more, for fluxes of no bin.
    rows = len(FLUX_BINS) + 1
    values, failed = np.zeros((rows, len(about), 6)), np.zeros(rows)
    galaxies: list[set[int]] = [set() for _ in range(rows)]
    for number_of, column, seen in looks(experiment, about, first, number):
        flux = np.array([seen.flux])
        row = next((k for k, one in enumerate(FLUX_BINS) if one.holds(flux)), len(FLUX_BINS))
        if (term := estimator.term(seen)) is None:
            failed[row] += 1
        elif term[1].any():
            galaxies[row].add(number_of)
            values[row, column] += np.concatenate([term[0], term[1].ravel()])
    return Sums(values, np.array([float(len(one)) for one in galaxies]), failed)


def looks(
    experiment: Experiment, about: Sequence[complex], first: int, number: int
) -> Iterator[tuple[int, int, Seen]]:
    """Draw galaxies ``first`` and on, and look at each: its number, the shear's, and what is seen."""
    rng = np.random.default_rng([experiment.seed, first])
    more_rng = np.random.default_rng([experiment.seed, first, 1])
    galaxies = experiment.draw(number, rng)
    size = experiment.size.prior(galaxies.flux)
    takes = [
        ([experiment.lens(take.galaxies(galaxies), g) for g in experiment.shears], take.noise)
        for take in experiment.takes
    ]
    for k in range(number):
        prior = ShapePrior(float(size.log_median[k]), float(size.sigma[k]))
        stage = experiment.beam.stage(prior.log_scale_length, prior.log_scale_length_sigma)
        noise, more = stage.noise(rng), stage.noise(more_rng)
        flux = float(galaxies.flux[k])
        bright = flux * stage.snr_of_jansky(prior, FITTED) >= experiment.snr_min
        if not bright or not experiment.flux_min <= flux <= experiment.flux_max:
            continue
        for column, shear in enumerate(about):
            for lensed, altered in takes:
                galaxy = _galaxy(lensed[column], k)
                facet = stage.facet(galaxy, experiment.profile, altered(stage, noise))
                added = altered(stage, more)
                yield k, column, Seen(facet, stage, prior, flux, shear, added)


def _galaxy(galaxies: Galaxies, k: int) -> GalaxyFit:
    return GalaxyFit(
        float(galaxies.flux[k]),
        np.array([galaxies.l[k], galaxies.m[k]]),
        complex(galaxies.ellipticity[k]),
        float(galaxies.scale_length[k]),
        0.0,
    )
