"""A crowded field behind known shears, observed and extracted whole: the same galaxies and the same noise each time."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from uvshear.bias.bias import LEAST_BLOCKS, Bias, fit_bias, is_told, shears_of
from uvshear.bias.estimators import mean_term, moment_term
from uvshear.estimators.estimator import within_reach
from uvshear.estimators.evidence import UnlensedPopulation, gradient_and_curvature
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.estimators.packing import unpack
from uvshear.execution import SERIAL, Executor
from uvshear.extraction.extraction import Extracted
from uvshear.extraction.keep import LikelihoodStatistic, MomentStatistic, Statistic
from uvshear.extraction.metacal import MetacalStatistic
from uvshear.galaxy import (
    DiscEllipticityPrior,
    EllipticityPrior,
    Exponential,
    Galaxies,
    Profile,
)
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.predict import predict_visibilities
from uvshear.progress import Progress
from uvshear.shapes.measurement import FitFlag
from uvshear.simulation.lensing import shear_galaxies
from uvshear.typing import Array, Bool, Float

BLOCKS = 7
"""Of the jackknife, along l and along m."""

ROUNDS = 2
"""Of an expansion about the estimate."""

NOTHING = np.full(6, np.nan)

Row = Float[Array, " 6"]
"""Two numbers of a galaxy and the four of their response; NaN where it has none."""

Extract = Callable[[VisibilitySet, Galaxies], Extracted]
"""Measures an observation of galaxies, whose places and fluxes a catalogue has."""


@dataclass(frozen=True)
class FieldExperiment:
    """What is simulated.

    Parameters
    ----------
    galaxies
        Before they are lensed.
    noise
        Visibilities without a galaxy, and their weights.
    shears
        Reduced shears that add up to zero.
    used
        Galaxies that are counted; the others are there all the same.
    lens
        What a shear does to galaxies.
    profile
        Of the galaxies.
    executor
        Of the prediction.
    """

    galaxies: Galaxies
    noise: VisibilitySet
    shears: tuple[complex, ...]
    used: Bool[Array, " source"]
    lens: Callable[[Galaxies, complex], Galaxies] = shear_galaxies
    profile: Profile = field(default_factory=Exponential)
    executor: Executor = SERIAL

    def seen(self, galaxies: Galaxies, sign: int) -> VisibilitySet:
        """Observe lensed galaxies, with the noise or its opposite."""
        blocks = []
        for block in self.noise.blocks:
            model = predict_visibilities(
                galaxies, block.uvw, block.frequency, self.profile, self.executor
            )
            data = (model + sign * block.stokes_i).astype(np.complex64)
            blocks.append(replace(block, stokes_i=data))
        return VisibilitySet(self.noise.phase_centre, tuple(blocks))


class FieldEstimator(ABC):
    """From what was extracted to what is summed."""

    statistics: tuple[Statistic, ...] = ()
    """To be kept by the extraction."""

    is_expanded: bool = False

    @abstractmethod
    def term(self, extracted: Extracted, source: int, flux: float, about: complex) -> Row:
        """Numbers of a source that was measured, of this flux in the catalogue [Jy]."""

    def terms(
        self, extracted: Extracted, flux: Float[Array, " source"], about: complex
    ) -> Float[Array, "source 6"]:
        """Numbers of all sources."""
        rows = np.full((len(flux), 6), np.nan)
        # A source may be missing: outside the field, or at the place of another.
        for k, shape in extracted.measurements.items():
            if shape.flag is FitFlag.OK:
                rows[k] = self.term(extracted, k, float(flux[k]), about)
        return rows


@dataclass(frozen=True)
class FieldMean(FieldEstimator):
    """Weighted mean of ellipticities."""

    population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)

    def term(self, extracted: Extracted, source: int, flux: float, about: complex) -> Row:
        """Ellipticity times lensfit's weight, and the weight."""
        return _row(*mean_term(extracted.measurements[source], self.population))


class FieldMoments(FieldEstimator):
    """Moments, weighed by the catalogue's flux."""

    is_expanded = True

    def __init__(self) -> None:
        """Make the statistic that keeps them."""
        self.statistics = (MomentStatistic(),)

    def term(self, extracted: Extracted, source: int, flux: float, about: complex) -> Row:
        """M_1, M_2 and their derivatives by the shear."""
        kept = extracted.kept.get(source)
        if kept is None or "m1" not in kept:
            return NOTHING
        return _row(*moment_term(kept, flux, about))


class FieldMetacal(FieldEstimator):
    """Ellipticities behind a round beam, with their response to a shear of the data."""

    def __init__(self, seed: int = 1) -> None:
        """``seed`` is that of the noise that is added."""
        self.statistics = (MetacalStatistic(seed=seed),)

    def term(self, extracted: Extracted, source: int, flux: float, about: complex) -> Row:
        """Weighted ellipticity, and its response."""
        kept = extracted.kept.get(source)
        if kept is None or "mc1" not in kept:
            return NOTHING
        return np.array([float(kept[name]) for name in MetacalStatistic.columns])


class FieldBayesian(FieldEstimator):
    """Gradient and curvature of the log probability of the data."""

    is_expanded = True

    def __init__(self, population: UnlensedPopulation | None = None) -> None:
        """Take the galaxies to come from a ``population``."""
        self._population = population or UnlensedPopulation()
        self.statistics = (LikelihoodStatistic(population=self._population.ellipticity),)

    def term(self, extracted: Extracted, source: int, flux: float, about: complex) -> Row:
        """Both, of one galaxy."""
        kept = extracted.kept.get(source)
        if kept is None or "lattice" not in kept:
            return NOTHING
        packed = {name: np.asarray(value) for name, value in kept.items()}
        return _row(*gradient_and_curvature(unpack(packed), self._population, about))


def _row(value: Float[Array, " 2"], response: Float[Array, "2 2"]) -> Row:
    return np.concatenate([value, response.ravel()])


def calibrate_field(
    experiment: FieldExperiment,
    estimators: Sequence[FieldEstimator],
    extract: Extract,
    step: Progress | None = None,
) -> list[list[Bias]]:
    """Bias of each estimator, in total and by flux, of galaxies that were measured every time."""
    galaxies, shears = experiment.galaxies, experiment.shears
    looks: list[list[Extracted]] = []
    count = 4 * len(shears)
    for shear in shears:
        found = []
        for ellipticity in (galaxies.ellipticity, -galaxies.ellipticity):
            lensed = experiment.lens(replace(galaxies, ellipticity=ellipticity), shear)
            for sign in (1, -1):
                found.append(extract(experiment.seen(lensed, sign), lensed))
                if step is not None:
                    step(len(found) + 4 * len(looks), count)
        looks.append(found)
    return [_calibrated(experiment, one, looks) for one in estimators]


def _calibrated(
    experiment: FieldExperiment, estimator: FieldEstimator, looks: Sequence[Sequence[Extracted]]
) -> list[Bias]:
    flux = experiment.galaxies.flux
    about = [0j] * len(experiment.shears)
    for _ in range(ROUNDS if estimator.is_expanded else 1):
        terms = np.array(
            [
                [estimator.terms(one, flux, g) for one in found]
                for g, found in zip(about, looks, strict=True)
            ]
        )
        good = np.isfinite(terms).all(axis=(0, 1, 3)) & experiment.used
        sums = terms[:, :, good].sum(axis=(1, 2))
        expanded_about, about = about, [within_reach(complex(*g)) for g in shears_of(sums, about)]
    return _by_flux(experiment, terms.sum(axis=1), good, expanded_about)


def _by_flux(
    experiment: FieldExperiment,
    terms: Float[Array, "shear source 6"],
    good: Bool[Array, " source"],
    about: Sequence[complex],
) -> list[Bias]:
    galaxies = experiment.galaxies
    rank = [np.argsort(np.argsort(x)) * BLOCKS // len(galaxies) for x in (galaxies.l, galaxies.m)]
    block = rank[0] * BLOCKS + rank[1]
    everyone = ("all", np.ones(len(galaxies), bool))
    biases = []
    for name, inside in (everyone, *((one.name, one.holds(galaxies.flux)) for one in FLUX_BINS)):
        wanted = experiment.used & inside
        chosen = wanted & good
        values = np.zeros((BLOCKS**2, len(experiment.shears), 6))
        np.add.at(values, block[chosen], terms[:, chosen].swapaxes(0, 1))
        if name != "all" and is_told(values).sum() < LEAST_BLOCKS:
            continue
        failed = int(wanted.sum() - chosen.sum())
        n = int(chosen.sum())
        biases.append(fit_bias(name, experiment.shears, about, values, n, failed))
    return biases
