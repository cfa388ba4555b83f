"""Estimators of the shear as the calibration runs them: from a galaxy's facet to its term of two sums."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field

import numpy as np

from uvshear.calibration.isolated import Stage
from uvshear.fit.likelihood import sample_likelihood
from uvshear.fit.measurement import FitFlag
from uvshear.fit.prior import ShapePrior
from uvshear.fit.shape import measure_shape
from uvshear.galaxy import DiscEllipticityPrior, EllipticityPrior, Exponential, Profile
from uvshear.interferometer.facet import Facet
from uvshear.measurement.keep import MomentStatistic
from uvshear.shear.bayesian import (
    ShapeLikelihood,
    UnlensedPopulation,
    gradient_and_curvature,
)
from uvshear.shear.moments import moment_weight
from uvshear.shear.weight import lensfit_weight
from uvshear.typing import Array, Float

Term = tuple[Float[Array, " 2"], Float[Array, "2 2"]]
"""Numbers of a galaxy, and their response to g1, g2."""


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
    """

    facet: Facet
    stage: Stage
    prior: ShapePrior
    flux: float
    about: complex = 0j


class Estimator(ABC):
    """From a facet to what is summed."""

    is_expanded: bool = False
    """Whether its numbers count from an estimate of the shear."""

    @abstractmethod
    def term(self, seen: Seen) -> Term | None:
        """Numbers and response of one galaxy; None where it has none."""


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
        weight = float(lensfit_weight(np.array([shape.e_sigma]), self.population)[0])
        return weight * shape.ellipticity, weight * np.eye(2)


class MomentEstimator(Estimator):
    """Moments of the visibility function, linear in the data."""

    def __init__(self, position_sigma: float = 0.0) -> None:
        """``position_sigma`` is the error of the catalogue's position in l and in m [rad]."""
        self._statistic = MomentStatistic(position_sigma)

    def term(self, seen: Seen) -> Term | None:
        """M_1, M_2 and their derivatives by the shear, weighed by the catalogue's flux."""
        kept = self._statistic.of(seen.facet, seen.stage.cutout)
        noise = (kept["m1_var"] + kept["m2_var"]) / 2
        weight = float(moment_weight(np.array([seen.flux]), np.array([noise]))[0])
        value = np.array([kept["m1"], kept["m2"]])
        response = np.array([[kept["r11"], kept["r12"]], [kept["r12"], kept["r22"]]])
        return weight * value, weight * response


@dataclass(frozen=True)
class BayesianEstimator(Estimator):
    """Gradient and curvature of the log probability of the data, about the current estimate of the shear."""

    profile: Profile = field(default_factory=Exponential)
    population: UnlensedPopulation = field(default_factory=UnlensedPopulation)
    is_expanded: bool = True

    def term(self, seen: Seen) -> Term | None:
        """Both, of one galaxy."""
        found = sample_likelihood(seen.facet, seen.prior, self.profile, self.population.ellipticity)
        if found is None:
            return None
        likelihood = ShapeLikelihood(
            found.samples.point,
            found.samples.origin,
            found.samples.axes,
            found.log_likelihood,
            found.flux,
            found.flux_variance,
        )
        return gradient_and_curvature(likelihood, self.population, seen.about)
