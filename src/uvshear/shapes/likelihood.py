"""The likelihood of a galaxy's shape, wherever a population makes it matter: what a Bayesian shear needs."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from uvshear.galaxy import EllipticityPrior, Profile
from uvshear.interferometer.facet import Facet
from uvshear.shapes.correlator import Correlator
from uvshear.shapes.interpolative import Condensation, CondensedCorrelator
from uvshear.shapes.maximum import maximise_likelihood
from uvshear.shapes.measurement import FitFlag
from uvshear.shapes.posterior import PosteriorSamples, Steps, quadrature, sample_about
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.shape import FLOAT32_SNR, is_determined, judge
from uvshear.typing import Array, Float

STEPS = Steps(relative=0.9, widest_e=0.08, most_points=20_000)
"""Fine enough to interpolate between: with 0.12 the curvature is 1.4 per cent off at 10 to 30 uJy, with 0.08 0.1."""

CONDENSED_SNR = 60.0
"""Signal-to-noise ratio below which templates may be condensed."""

_FLATTENED = 0.9
_BEYOND = 0.15


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
    facet: Facet,
    prior: ShapePrior,
    profile: Profile,
    population: EllipticityPrior,
    condensation: Callable[[], Condensation] | None = None,
) -> LikelihoodSamples | None:
    """Likelihood over all shapes of the population that the data allow; None where there is no galaxy.

    With a ``condensation`` of the facet's cells for the ``profile``, galaxies below ``CONDENSED_SNR`` take half the
    time.
    """
    expected = replace(
        prior,
        ellipticity=_Wider(population),
        ellipticity_sigma=math.sqrt(population.population_variance),
    )
    correlator = Correlator(facet, profile)
    best = maximise_likelihood(correlator, expected)
    if best is not None and best.snr > FLOAT32_SNR:
        correlator = Correlator(facet, profile, np.float64)
        best = maximise_likelihood(correlator, expected)
    if best is None or not is_determined(best):
        return None
    if judge(best, correlator, expected) is not FitFlag.OK:
        return None
    condensed = (
        CondensedCorrelator(correlator, condensation())
        if condensation is not None and best.snr < CONDENSED_SNR
        else correlator
    )
    position, others = quadrature(correlator, condensed, expected, best)
    samples = sample_about(best, position, expected, others, steps=STEPS)
    if not samples.is_covered or not np.all(np.isfinite(samples.probability)):
        return None
    given, unit = samples.given_shape, correlator.flux_unit
    return LikelihoodSamples(
        samples, given.log_likelihood, given.flux * unit, given.flux_variance * unit**2
    )
