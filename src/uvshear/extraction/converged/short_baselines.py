r"""What short baselines tell of galaxies, and whether they can be left out.

The Fisher matrix of a galaxy of the parameters (ln S, e1, e2, ln alpha) is a sum over the samples,

.. math:: F = P + \sum_k w_k\, \nabla\mu_k \nabla\mu_k^T, \qquad \mu = S\, \tilde I(4\pi^2 \alpha^2 |k|^2)

with P the priors. Its inverse holds the squares of the errors; without the samples on short baselines they are larger.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.extraction.field import Field
from uvshear.galaxy import Profile
from uvshear.geometry.ellipticity import quadratic_form
from uvshear.interferometer.samples import Samples
from uvshear.typing import Array, Float


@dataclass(frozen=True)
class Growth:
    """Largest factors by which errors may grow where baselines are left out.

    Parameters
    ----------
    flux, ellipticity, size
        Factors of the errors of ln S, of e1 and e2, and of ln alpha.
    """

    flux: float
    ellipticity: float
    size: float

    def allows(self, factors: Float[Array, " 4"]) -> bool:
        """Tell whether factors of the errors of (ln S, e1, e2, ln alpha) are within the limits."""
        limits = np.array([self.flux, self.ellipticity, self.ellipticity, self.size])
        return bool((factors <= limits).all())


@dataclass(frozen=True)
class Typical:
    """A galaxy with its prior.

    Parameters
    ----------
    flux
        Flux [Jy].
    log_size
        Logarithm of the scale length [rad].
    sigma
        Standard deviation of the prior on this logarithm.
    """

    flux: float
    log_size: float
    sigma: float


DENSE_CORE = Growth(flux=6.0, ellipticity=1.15, size=2.0)
"""Growth up to which short baselines are left out. With the limit by the sizes of galaxies of 10 to 200 uJy, the errors
of the flux, of e and of the size of a large galaxy grow by factors of 4.0, 1.05 and 1.8 with SKA-Mid AA4, of 3.2, 1.05
and 1.8 with AA2, and of 1.1, 1.00 and 1.03 with MeerKAT, where the many short baselines of a dense core would couple
the fluxes of all sources. With e-MERLIN, which has few, those of the median galaxy would grow by 22, 1.04 and 2.8."""

STEP = 1e-4
"""Step of the derivatives."""

LOOSE = np.array([1e-2, 4.4, 4.4])
"""Precisions of the priors on ln S, which is hardly known, and on e1 and e2, which are uniform within the unit disc."""


def are_dispensable(
    field: Field,
    galaxies: Sequence[Typical],
    profile: Profile,
    limit: float,
    longest: float,
) -> bool:
    """Tell whether the baselines below a limit can be left out without too much harm to typical galaxies.

    Parameters
    ----------
    field
        Field whose probes represent the samples.
    galaxies
        Typical galaxies.
    profile
        Brightness profile.
    limit
        Baseline below which all would be left out [wavelengths].
    longest
        Longest baseline that is used [wavelengths].
    """
    probes = field.summary.probes
    distance = probes.uv_distance
    used = probes.select((distance >= field.uv_range.minimum) & (distance < longest))
    if not (used.uv_distance < limit).any():
        return True
    samples = field.summary.samples / len(probes)
    factors = [_growth(used, samples, galaxy, profile, limit) for galaxy in galaxies]
    return all(DENSE_CORE.allows(factor) for factor in factors)


def _growth(
    probes: Samples,
    samples: float,
    galaxy: Typical,
    profile: Profile,
    limit: float,
) -> Float[Array, " 4"]:
    """Factors by which the errors of (ln S, e1, e2, ln alpha) grow without the baselines below a limit."""
    gradient = _gradient(probes.uvw[:, :2].astype(float), galaxy, profile)
    gradient *= np.sqrt(probes.weights.astype(float) * samples)[:, None]
    prior = np.diag([*LOOSE, galaxy.sigma**-2])
    kept = gradient[probes.uv_distance >= limit]
    return _errors(kept.T @ kept + prior) / _errors(gradient.T @ gradient + prior)


def _gradient(
    uv: Float[Array, "sample 2"], galaxy: Typical, profile: Profile
) -> Float[Array, "sample 4"]:
    """Differentiate the visibilities of a round galaxy by ln S, e1, e2 and ln alpha [Jy]."""
    u, v = uv.T
    squares = 4 * np.pi**2 * np.stack([u**2, u * v, v**2])

    def model(e: complex, step: float = 0.0) -> Float[Array, " sample"]:
        size = np.exp([galaxy.log_size + step])
        form = np.stack(quadratic_form(np.array([e], complex), size), axis=-1)[0]
        return galaxy.flux * profile.envelope(form @ squares)

    return np.column_stack(
        [
            model(0j),
            (model(STEP) - model(-STEP)) / (2 * STEP),
            (model(1j * STEP) - model(-1j * STEP)) / (2 * STEP),
            (model(0j, STEP) - model(0j, -STEP)) / (2 * STEP),
        ]
    )


def _errors(information: Float[Array, "4 4"]) -> Float[Array, " 4"]:
    scale = np.sqrt(np.diag(information))
    return np.sqrt(np.diag(np.linalg.inv(information / np.outer(scale, scale)))) / scale
