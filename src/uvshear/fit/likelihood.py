"""The likelihood of a galaxy's shape, wherever a population makes it matter: what a Bayesian shear needs."""

import math
from dataclasses import dataclass, replace

import numpy as np

from uvshear.fit.correlator import Correlator
from uvshear.fit.maximum import maximise_likelihood
from uvshear.fit.posterior import PosteriorSamples, sample_posterior
from uvshear.fit.prior import ShapePrior
from uvshear.fit.shape import FLOAT32_SNR
from uvshear.galaxy import EllipticityPrior, Profile
from uvshear.interferometer.facet import Facet
from uvshear.typing import Array, Float

WIDEST_STEP = 0.06
"""In e: the core of the population's ellipticities is 0.07 wide."""

_FLATTENED = 0.9
_BEYOND = 0.1


@dataclass(frozen=True)
class _Wider(EllipticityPrior):
    """A population's density, flattened near its end and continued beyond, where a shear may take it."""

    population: EllipticityPrior

    @property
    def maximum(self) -> float:  # type: ignore[override]
        return min(self.population.maximum + _BEYOND, 0.98)

    def relative_density(self, modulus: Float[Array, "..."]) -> Float[Array, "..."]:
        return self.population.relative_density(
            np.minimum(modulus, _FLATTENED * self.population.maximum)
        )


@dataclass(frozen=True)
class LikelihoodSamples:
    """Nodes of equal weight over (e, ln alpha), and the likelihood there; fluxes in Jy."""

    samples: PosteriorSamples
    log_likelihood: Float[Array, " sample"]
    flux: Float[Array, " sample"]
    flux_variance: Float[Array, " sample"]


def sample_likelihood(
    facet: Facet, prior: ShapePrior, profile: Profile, population: EllipticityPrior
) -> LikelihoodSamples | None:
    """Likelihood over all shapes of the population that the data allow; None where there is no galaxy."""
    expected = replace(
        prior,
        ellipticity=_Wider(population),
        ellipticity_sigma=math.sqrt(population.population_variance),
    )
    correlator = Correlator(facet, profile)
    best = maximise_likelihood(correlator, expected)
    if best is None or not best.has_converged:
        return None
    if best.snr > FLOAT32_SNR:
        correlator = Correlator(facet, profile, np.float64)
        best = maximise_likelihood(correlator, expected)
        if best is None or not best.has_converged:
            return None
    samples = sample_posterior(correlator, expected, best, widest_e=WIDEST_STEP)
    if not samples.is_covered:
        return None
    given, unit = samples.given_shape, correlator.flux_unit
    return LikelihoodSamples(
        samples, given.log_likelihood, given.flux * unit, given.flux_variance * unit**2
    )
