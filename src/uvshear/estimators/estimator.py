"""Estimators of the shear of chosen galaxies: all of them, or those of a bin in flux."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from uvshear.errors import InputError
from uvshear.estimators.evidence import (
    ShapeLikelihood,
    UnlensedPopulation,
    gradient_and_curvature,
)
from uvshear.estimators.flux_bins import FLUX_BINS
from uvshear.estimators.mean import ShearEstimate, weighted_mean_shear
from uvshear.estimators.moments import about_shear, moment_weight
from uvshear.estimators.population_fit import FittedPopulation, fit_population
from uvshear.estimators.ratio import Responses
from uvshear.progress import Meter
from uvshear.typing import Array, Bool, Complex, Float

ROUNDS = 3
"""Of the expansion about the estimate: what is left is of the fourth order in its first error."""

LARGEST = 0.3
"""Shear that an expansion is taken about, at most."""

FEWEST = 20
"""Galaxies of a bin of flux that is told."""

LEAST = 2
"""Galaxies that a shear needs."""


class ShearEstimator(ABC):
    """What the shear of a sample is estimated from."""

    @abstractmethod
    def of(self, chosen: Bool[Array, " source"]) -> ShearEstimate:
        """Shear of the chosen galaxies that it can use."""

    @property
    @abstractmethod
    def usable(self) -> Bool[Array, " source"]:
        """Galaxies that have what it needs."""


@dataclass(frozen=True)
class MeanShear(ShearEstimator):
    """Weighted mean of ellipticities (weight 0: of no use), its errors by bootstraps of this seed."""

    ellipticity: Complex[Array, " source"]
    weight: Float[Array, " source"]
    seed: int = 1

    @property
    def usable(self) -> Bool[Array, " source"]:
        """Those with weight."""
        return np.isfinite(self.ellipticity) & (self.weight > 0)

    def of(self, chosen: Bool[Array, " source"]) -> ShearEstimate:
        """Mean of the chosen."""
        rng = np.random.default_rng(self.seed)
        return weighted_mean_shear(self.ellipticity[chosen], self.weight[chosen], rng)


@dataclass(frozen=True)
class MomentShear(ShearEstimator):
    """Moments [Jy] with their responses, weighed by the catalogue's flux [Jy]; NaN where there are none.

    ``third`` is their third order, K of ``fit.moments`` [Jy].
    """

    moments: Responses
    third: Float[Array, " source"]
    variance: Float[Array, " source"]
    flux: Float[Array, " source"]

    @property
    def usable(self) -> Bool[Array, " source"]:
        """Those with moments."""
        return np.isfinite(self.moments.value).all(axis=-1)

    def of(self, chosen: Bool[Array, " source"]) -> ShearEstimate:
        """Sum of the chosen galaxies' moments over that of their responses, expanded about the estimate."""
        used = chosen & self.usable
        weight = moment_weight(self.flux[used], self.variance[used])

        def step(about: complex) -> ShearEstimate:
            moments = about_shear(self.moments.select(used), self.third[used], about)
            return moments.weighted(weight).shear("moments")

        return _expanded(step)


@dataclass(frozen=True)
class MetacalShear(ShearEstimator):
    """Weighted ellipticities behind a round beam, with their response to a shear of the data; NaN: there are none."""

    shapes: Responses

    @property
    def usable(self) -> Bool[Array, " source"]:
        """Those that were measured."""
        return np.isfinite(self.shapes.value).all(axis=-1)

    def of(self, chosen: Bool[Array, " source"]) -> ShearEstimate:
        """Sum of the chosen galaxies' ellipticities over that of their responses."""
        return self.shapes.select(chosen & self.usable).shear("metacal")


@dataclass(frozen=True)
class BayesianShear(ShearEstimator):
    """Likelihoods behind the shear of a population; None where a galaxy has none. The meter counts looks at them."""

    likelihoods: Sequence[ShapeLikelihood | None]
    population: UnlensedPopulation = field(default_factory=UnlensedPopulation)
    meter: Meter = field(default_factory=lambda: Meter(None))

    @property
    def usable(self) -> Bool[Array, " source"]:
        """Those with a likelihood."""
        return np.array([one is not None for one in self.likelihoods])

    def fit_population(self, chosen: Bool[Array, " source"]) -> FittedPopulation:
        """Fit the population to the chosen galaxies, about their shear."""
        estimate = self.of(chosen)
        about = complex(estimate.g1, estimate.g2)
        return fit_population(self._chosen(chosen), self.population, about, self.meter)

    def _chosen(self, chosen: Bool[Array, " source"]) -> list[ShapeLikelihood]:
        pairs = zip(self.likelihoods, chosen.tolist(), strict=True)
        return [one for one, is_in in pairs if is_in and one is not None]

    def of(self, chosen: Bool[Array, " source"]) -> ShearEstimate:
        """Shear at which the chosen galaxies are most probable."""
        used = self._chosen(chosen)
        self.meter.expect(ROUNDS * len(used))
        return _expanded(lambda about: self._step(used, about))

    def _step(self, used: Sequence[ShapeLikelihood], about: complex) -> ShearEstimate:
        terms = [self._term(one, about) for one in used]
        # Those that the population does not have say nothing.
        telling = [(q, h) for q, h in terms if h.any()]
        if len(telling) < LEAST:
            raise InputError(
                f"the shear of {len(telling)} galaxies that the population has, of {len(used)} with a"
                f" likelihood; {LEAST} or more are needed"
            )
        value, response = (np.array(part) for part in zip(*telling, strict=True))
        return Responses(value, response, about).shear("bayesian")

    def _term(
        self, one: ShapeLikelihood, about: complex
    ) -> tuple[Float[Array, " 2"], Float[Array, "2 2"]]:
        found = gradient_and_curvature(one, self.population, about)
        self.meter.add()
        return found


def _expanded(step: Callable[[complex], ShearEstimate]) -> ShearEstimate:
    """Shear after ``ROUNDS`` steps from none, each expanded about the one before."""
    about = 0j
    for _ in range(ROUNDS - 1):
        estimate = step(about)
        about = within_reach(complex(estimate.g1, estimate.g2))
    return step(about)


def within_reach(shear: complex) -> complex:
    """Return the shear, or one of ``LARGEST`` in its direction: a first estimate of few galaxies may be anything."""
    return shear * min(1.0, LARGEST / max(abs(shear), 1e-12))


def by_flux(
    estimator: ShearEstimator, flux: Float[Array, " source"], chosen: Bool[Array, " source"]
) -> dict[str, ShearEstimate]:
    """Shear of the chosen galaxies in each bin of the catalogue's flux [Jy] that has enough of them to tell one."""
    found = {}
    for one in FLUX_BINS:
        inside = chosen & estimator.usable & one.holds(flux)
        if inside.sum() < FEWEST:
            continue
        try:
            found[one.name] = estimator.of(inside)
        except InputError:
            # Galaxies that a population does not have tell nothing, however many there are.
            continue
    return found
