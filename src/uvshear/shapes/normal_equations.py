r"""How much the parameters of sources have to do with one another: blocks of their common Fisher matrix.

.. math:: F_{ij} = \Big\langle \frac{\partial m_i}{\partial\theta_i}, \frac{\partial m_j}{\partial\theta_j} \Big\rangle

with theta = flux, e1, e2, ln alpha, l, m of each.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uvshear.galaxy import Profile
from uvshear.interferometer.facet import BeamPlane, Facet
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.prior import ShapePrior
from uvshear.shapes.template import PARAMETERS, Template
from uvshear.typing import Array, Complex, Float


@dataclass(frozen=True)
class NormalEquations:
    """Gradient of one source's log posterior at its present parameters, and its own block of the Fisher matrix.

    Priors, those of a sky model too, are in both.
    """

    gradient: Float[Array, " 6"]
    information: Float[Array, "6 6"]


def normal_equations(
    residual: Facet, prior: ShapePrior, profile: Profile, fit: GalaxyFit
) -> NormalEquations:
    """For a facet from which everything is subtracted, the source too."""
    responses = Template(residual.uv, profile).responses(fit)
    data = residual.correlation[None, :].astype(np.complex64)
    gradient = real_product(responses, data)[:, 0]
    weighted = responses * residual.power.astype(np.float32)
    information = real_product(weighted, responses)
    pull, precision = prior.pull(fit)
    return NormalEquations(gradient + pull, information + np.diag(precision))


def couplings(
    places: Sequence[tuple[float, float]],
    fits: Sequence[GalaxyFit],
    profile: Profile,
    plane: BeamPlane,
    first: int,
) -> Float[Array, "first six source six"]:
    """Blocks of the ``first`` sources with all of them; ``places`` are their facets' centres [rad]."""
    responses = np.concatenate(
        [
            Template(plane.uv, profile, place).responses(fit)
            for place, fit in zip(places, fits, strict=True)
        ]
    )
    weighted = responses[: first * PARAMETERS] * plane.power.astype(np.float32)
    blocks = real_product(weighted, responses)
    return blocks.reshape(first, PARAMETERS, len(fits), PARAMETERS)


def real_product(
    a: Complex[Array, "row cell"], b: Complex[Array, "column cell"]
) -> Float[Array, "row column"]:
    """Re sum a b*, in the precision of the cells."""
    left = np.ascontiguousarray(a).view(np.float32).reshape(len(a), -1)
    right = np.ascontiguousarray(b).view(np.float32).reshape(len(b), -1)
    return (left @ right.T).astype(float)
