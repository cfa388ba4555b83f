"""Estimators of the shear as the calibration runs them: from a galaxy's facet to its term of two sums."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from uvshear.bias.isolated import Noise, Stage
from uvshear.estimators.evidence import UnlensedPopulation, gradient_and_curvature
from uvshear.estimators.moments import about_shear, moment_weight
from uvshear.estimators.population_fit import fit_population
from uvshear.estimators.ratio import Responses
from uvshear.extraction.keep import Kept, LikelihoodStatistic, MomentStatistic
from uvshear.extraction.metacal import Metacal, Term
from uvshear.galaxy import DiscEllipticityPrior, EllipticityPrior, Exponential, Profile
from uvshear.imaging.cutout import Cutout
from uvshear.interferometer.facet import Facet
from uvshear.shapes.measurement import FitFlag, ShapeMeasurement
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import fit_galaxy, measure_shape
from uvshear.shapes.weight import lensfit_weight
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Seen:
    """What an estimator is given of a galaxy: its facet, and what a catalogue knows.

    Parameters
    ----------
    facet, stage
        Its statistics, and where they come from.
    prior
        Of its size.
    flux
        Of the catalogue [Jy].
    about
        Current estimate of the shear.
    more_noise
        That may be added to the facet's, independent of it, in standard deviations of each cell's.
    """

    facet: Facet
    stage: Stage
    prior: ShapePrior
    flux: float
    about: complex
    more_noise: Noise


class Estimator(ABC):
    """From a facet to what is summed."""

    is_expanded: bool = False
    """Whether its numbers count from an estimate of the shear."""

    is_learning: bool = False
    """Whether it takes something from a sample first."""

    @abstractmethod
    def term(self, seen: Seen) -> Term | None:
        """Numbers and response of one galaxy; None where it has none."""

    def learned(self, sample: Sequence[Seen]) -> "Estimator":
        """Return it with what a sample has taught it."""
        return self


@dataclass(frozen=True)
class MeanEstimator(Estimator):
    """Weighted mean of posterior-mean ellipticities, as Rivi & Miller 2018 do it."""

    profile: Profile = field(default_factory=Exponential)
    population: EllipticityPrior = field(default_factory=DiscEllipticityPrior)

    def term(self, seen: Seen) -> Term | None:
        """Ellipticity times lensfit's weight, and the weight."""
        shape = measure_shape(seen.facet, seen.prior, self.profile)
        if shape.flag is not FitFlag.OK:
            return None
        return mean_term(shape, self.population)


def mean_term(shape: ShapeMeasurement, population: EllipticityPrior) -> Term:
    """Ellipticity times lensfit's weight, and the weight."""
    weight = float(lensfit_weight(np.array([shape.e_sigma]), population)[0])
    return weight * shape.ellipticity, weight * np.eye(2)


class MomentEstimator(Estimator):
    """Moments of the visibility function, linear in the data."""

    is_expanded = True

    def __init__(self, position_sigma: float = 0.0) -> None:
        """``position_sigma`` is the error of the catalogue's position in l and in m [rad]."""
        self._statistic = MomentStatistic(position_sigma)

    def term(self, seen: Seen) -> Term | None:
        """M_1, M_2 and their derivatives by the shear, weighed by the catalogue's flux."""
        kept = self._statistic.of(seen.facet, seen.stage.cutout, seen.prior, ())
        return moment_term(kept, seen.flux, seen.about)


def moment_term(kept: Kept, flux: float, about: complex) -> Term:
    """Moments and responses of a galaxy about a shear, weighed by its flux in the catalogue [Jy]."""
    noise = (kept["m1_var"] + kept["m2_var"]) / 2
    weight = moment_weight(np.array([flux]), np.array([noise]))
    value = np.array([[kept["m1"], kept["m2"]]])
    response = np.array([[[kept["r11"], kept["r12"]], [kept["r12"], kept["r22"]]]])
    third = np.array([kept["r_third"]])
    term = about_shear(Responses(value, response), third, about).weighted(weight)
    return term.value[0], term.response[0]


class SelectedEstimator(Estimator):
    """Another estimator, of galaxies whose fitted signal-to-noise ratio is high enough: shear and noise have a say."""

    def __init__(self, estimator: Estimator, snr_min: float) -> None:
        """``snr_min`` is the least S sqrt<m, m> of the best fit."""
        self._estimator, self._snr_min = estimator, snr_min
        self.is_expanded, self.is_learning = estimator.is_expanded, estimator.is_learning

    def term(self, seen: Seen) -> Term | None:
        """Give the other's term, or nothing at all."""
        fit = fit_galaxy(seen.facet, seen.prior, Exponential())
        if fit is None or fit.snr < self._snr_min:
            return np.zeros(2), np.zeros((2, 2))
        return self._estimator.term(seen)

    def learned(self, sample: Sequence[Seen]) -> "SelectedEstimator":
        """Let the other learn."""
        return SelectedEstimator(self._estimator.learned(sample), self._snr_min)


class MetacalEstimator(Estimator):
    """Another estimator's numbers behind a round beam, with their response to a shear of the data itself.

    It is about no shear, and so has the third order in it: 0.002 of m at |g| = 0.03 for moments.
    """

    def __init__(self, estimator: Estimator) -> None:
        """Wrap it."""
        self._estimator, self._metacal = estimator, Metacal()
        self.is_learning = estimator.is_learning

    def term(self, seen: Seen) -> Term | None:
        """Numbers of the other, and their differences between sheared data."""

        def measure(facet: Facet, cells: Cutout) -> Float[Array, " 2"] | None:
            stage = Stage(cells, facet.power)
            # About zero always: an own expansion would take out what the response is there to take out.
            behind = replace(seen, facet=facet, stage=stage, about=0j)
            found = self._estimator.term(behind)
            return None if found is None else found[0]

        return self._metacal.term(seen.facet, seen.stage.cutout, seen.more_noise, measure)

    def learned(self, sample: Sequence[Seen]) -> "MetacalEstimator":
        """Let the other learn."""
        return MetacalEstimator(self._estimator.learned(sample))


class BayesianEstimator(Estimator):
    """Gradient and curvature of the log probability of the data, about the current estimate of the shear."""

    is_expanded = True

    def __init__(
        self,
        profile: Profile | None = None,
        population: UnlensedPopulation | None = None,
        *,
        is_learning: bool = False,
    ) -> None:
        """``profile`` is what galaxies are fitted with, ``population`` what they are taken to come from.

        One that is learning takes that for a start, and fits a population to its sample.
        """
        self._population = population or UnlensedPopulation()
        self._profile, self.is_learning = profile, is_learning
        self._statistic = LikelihoodStatistic(profile, self._population.ellipticity)

    def learned(self, sample: Sequence[Seen]) -> "BayesianEstimator":
        """Fit the population to galaxies that nothing has lensed."""
        found = [self._statistic.likelihood(s.facet, s.stage.cutout, s.prior) for s in sample]
        likelihoods = [one for one in found if one is not None]
        fitted = fit_population(likelihoods, self._population, 0j)
        return BayesianEstimator(self._profile, fitted.population)

    def term(self, seen: Seen) -> Term | None:
        """Both, of one galaxy."""
        likelihood = self._statistic.likelihood(seen.facet, seen.stage.cutout, seen.prior)
        if likelihood is None:
            return None
        return gradient_and_curvature(likelihood, self._population, seen.about)
