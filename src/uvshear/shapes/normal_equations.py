r"""Normal equations of sources, and the blocks of their joint Fisher matrix.

.. math:: F_{ij} = \Big\langle \frac{\partial m_i}{\partial\theta_i}, \frac{\partial m_j}{\partial\theta_j} \Big\rangle

with theta = flux, e1, e2, ln alpha, l, m of each source.
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

    Both include the priors, with the terms of a sky model.
    """

    gradient: Float[Array, " 6"]
    information: Float[Array, "6 6"]


def normal_equations(
    residual: Facet, prior: ShapePrior, profile: Profile, fit: GalaxyFit
) -> NormalEquations:
    """Compute the normal equations of one source.

    Parameters
    ----------
    residual
        Facet from which all sources are subtracted, including this one.
    prior
        Prior of the source.
    profile
        Brightness profile of the source.
    fit
        Present parameters of the source.
    """
    responses = Template(residual.uv, profile).responses(fit)
    data = residual.correlation[None, :].astype(np.complex64)
    gradient = real_product(responses, data)[:, 0]
    weighted = responses * residual.power.astype(np.float32)
    information = real_product(weighted, responses)
    pull, precision = prior.pull(fit)
    return NormalEquations(gradient + pull, information + np.diag(precision))


def fisher_blocks(
    places: Sequence[tuple[float, float]],
    fits: Sequence[GalaxyFit],
    profile: Profile,
    plane: BeamPlane,
    first: int,
) -> Float[Array, "first six source six"]:
    """Blocks of the Fisher matrix that couple the ``first`` sources of a list to all of the list.

    Parameters
    ----------
    places
        Centres of the sources' facets [rad].
    fits
        Parameters of the sources.
    profile
        Brightness profile of the sources.
    plane
        Beam that the sources have in common.
    first
        Number of sources whose rows are returned.
    """
    responses = np.empty((len(fits), PARAMETERS, len(plane.power)), np.complex64)
    for place, fit, out in zip(places, fits, responses, strict=True):
        Template(plane.uv, profile, place).write_responses(fit, out)
    rows = responses.reshape(-1, len(plane.power))
    weighted = rows[: first * PARAMETERS] * plane.power.astype(np.float32)
    blocks = real_product(weighted, rows)
    return blocks.reshape(first, PARAMETERS, len(fits), PARAMETERS)


def real_product(
    a: Complex[Array, "row cell"], b: Complex[Array, "column cell"]
) -> Float[Array, "row column"]:
    """Real part of sum a b*, in the precision of the cells."""
    left = np.ascontiguousarray(a).view(np.float32).reshape(len(a), -1)
    right = np.ascontiguousarray(b).view(np.float32).reshape(len(b), -1)
    return (left @ right.T).astype(float)
