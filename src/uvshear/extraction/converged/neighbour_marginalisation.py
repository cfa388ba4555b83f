"""Marginalisation of the parameters of a source over those of its neighbours: wider errors, and a shift."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.extraction.converged.couplings import CouplingBlocks
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.numerics.symmetric import regularised_inverse, with_eigenvalue_floor
from uvshear.shapes.normal_equations import NormalEquations
from uvshear.shapes.template import PARAMETERS
from uvshear.typing import Array, Float

MOST_NEIGHBOURS = 8
"""Largest number of neighbours over which a source is marginalised, the nearest first."""


@dataclass(frozen=True)
class NeighbourMarginalisation:
    """Covariance of a source's parameters by their Fisher matrix, with neighbours fixed and with neighbours free.

    Parameters
    ----------
    conditional
        Covariance of the parameters with the neighbours fixed where they are.
    marginal
        Covariance of the parameters with the neighbours free.
    shift
        Change of the parameters, from those for fixed neighbours, when the neighbours follow.
    """

    conditional: Float[Array, "6 6"]
    marginal: Float[Array, "6 6"]
    shift: Float[Array, " 6"]

    @property
    def information_fraction(self) -> float:
        """Fraction of the information on e that remains with the neighbours free."""
        conditional, marginal = (
            np.linalg.det(covariance[1:3, 1:3]) for covariance in (self.conditional, self.marginal)
        )
        return math.sqrt(min(conditional / marginal, 1.0))


def marginalise_neighbours(
    source: int,
    others: Sequence[int],
    equations: Sequence[NormalEquations],
    blocks: CouplingBlocks,
    sky_prior: tuple[Float[Array, " 6"], Float[Array, " 6"]],
) -> NeighbourMarginalisation:
    """Marginalise the parameters of a source over those of its neighbours.

    ``sky_prior`` is the gradient and the precision of the prior that the source has in the sky but not in its
    measurement. Where the sky has converged the gradient of the likelihood is the opposite of that of the prior:
    without the prior the source moves by its covariance times that, and farther if its neighbours are free, because
    they have absorbed the flux that the prior has kept the source from fitting.
    """
    group = [source, *others]
    count = len(group)
    pull, precision = sky_prior
    own = equations[source].information - np.diag(precision)
    matrix = np.zeros((count, PARAMETERS, count, PARAMETERS))
    for a, i in enumerate(group):
        shared = blocks.between(i, i)
        # A source's own facet tells more than the baselines that it shares with others.
        beyond = (own if i == source else equations[i].information) - shared
        matrix[a, :, a, :] = shared + with_eigenvalue_floor(beyond, 0.0)
        for b, j in enumerate(group[:a]):
            block = blocks.between(i, j)
            if block is not None:
                matrix[a, :, b, :] = block
                matrix[b, :, a, :] = block.T
    # Rounding may leave an eigenvalue of sources at one place below zero.
    conditional = regularised_inverse(matrix[0, :, 0, :])
    marginal = regularised_inverse(matrix.reshape(count * PARAMETERS, -1))[:PARAMETERS, :PARAMETERS]
    return NeighbourMarginalisation(conditional, marginal, (conditional - marginal) @ pull)


@dataclass(frozen=True)
class NeighbourMarginaliser:
    """Marginalises the neighbours of each source of a sky about which the log posterior is known to second order."""

    state: SkyState
    equations: Sequence[NormalEquations]
    blocks: CouplingBlocks

    @classmethod
    def from_state(cls, state: SkyState) -> Self | None:
        """Prepare for all sources of a sky; None where there was no joint step."""
        if state.linearisation is None:
            return None
        flux = np.array([fit.flux for fit in state.fits])
        blocks = CouplingBlocks(state.linearisation.couplings, flux)
        return cls(state, state.linearisation.equations, blocks)

    def marginalise(self, source: int) -> NeighbourMarginalisation | None:
        """Marginalise the neighbours of a source; None where it has none near."""
        state = self.state
        if state.fits[source].snr <= 0:
            return None
        near = state.neighbourhood.nearest_to(source)
        others = [other for other in near if state.fits[other].snr > 0][:MOST_NEIGHBOURS]
        if not others:
            return None
        prior, fit = state.sources[source].prior, state.fits[source]
        (pull, precision), (own_pull, own_precision) = prior.pull(fit), prior.measured.pull(fit)
        sky_prior = pull - own_pull, precision - own_precision
        return marginalise_neighbours(source, others, self.equations, self.blocks, sky_prior)
