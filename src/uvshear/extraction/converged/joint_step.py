"""One Gauss-Newton step of all sources at once.

Fitted in turn, overlapping galaxies creep along the valley of their common likelihood, and the broad plateau of a
natural-weight beam lets whole neighbourhoods creep together. The gradients are exact, from the facets; the blocks of
the Fisher matrix between sources only have to point downhill, so they are taken from the shorter half of the
baselines and end at some distance.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg

from uvshear.execution import Executor
from uvshear.extraction.converged.beams import Beams
from uvshear.extraction.converged.interaction import Interaction
from uvshear.galaxy import Profile
from uvshear.numerics.symmetric import regularised_inverse, with_eigenvalue_floor
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.normal_equations import NormalEquations, fisher_blocks
from uvshear.shapes.template import PARAMETERS
from uvshear.typing import Array, Bool, Float, Int

DAMPING = 0.2
"""Keeps the matrix positive, which is cut off at some distance, and steps short where sources are hard to tell apart:
along such valleys groups take checked steps of their own (``fit.blend``)."""

_SOLVED = 1e-3
_MOST_ITERATIONS = 200

HELD = 1e9


@dataclass(frozen=True)
class Couplings:
    """Fisher matrix between sources: blocks of those near one another, each pair once (i < j), and far fluxes.

    ``own`` are the sources' own blocks of the same baselines: with them the matrix is positive.
    """

    first: Int[Array, " pair"]
    second: Int[Array, " pair"]
    blocks: Float[Array, "pair 6 6"]
    own: Float[Array, "source 6 6"]
    far: sparse.csr_matrix
    flux: Float[Array, " source"]

    def at_flux(self, flux: Float[Array, " source"]) -> Float[Array, "pair 6 6"]:
        """Blocks for other fluxes than those they were worked out for: all responses but the first grow with them."""
        ratio = self._grown(flux)
        return self.blocks * (ratio[self.first][:, :, None] * ratio[self.second][:, None, :])

    def own_at_flux(self, flux: Float[Array, " source"]) -> Float[Array, "source 6 6"]:
        """Own blocks for other fluxes."""
        ratio = self._grown(flux)
        return self.own * (ratio[:, :, None] * ratio[:, None, :])

    def _grown(self, flux: Float[Array, " source"]) -> Float[Array, "source 6"]:
        ratio = np.ones((len(flux), PARAMETERS))
        is_there = (self.flux > 0) & (flux > 0)
        ratio[is_there, 1:] = (flux[is_there] / self.flux[is_there])[:, None]
        return ratio

    def blocks_with_diagonal(
        self,
        own: Float[Array, "source 6 6"],
        scale: Float[Array, "source 6"],
        flux: Float[Array, " source"],
    ) -> sparse.bsr_matrix:
        """All blocks, rows and columns divided by ``scale``; ``own`` are divided already."""
        i, j = self.first, self.second
        scaled = self.at_flux(flux) / (scale[i][:, :, None] * scale[j][:, None, :])
        count = len(own)
        diagonal = np.arange(count)
        rows = np.concatenate([diagonal, i, j])
        columns = np.concatenate([diagonal, j, i])
        blocks = np.concatenate([own, scaled, scaled.swapaxes(1, 2)])
        order = np.lexsort((columns, rows))
        starts = np.searchsorted(rows[order], np.arange(count + 1))
        shape = (count * PARAMETERS, count * PARAMETERS)
        return sparse.bsr_matrix((blocks[order], columns[order], starts), shape=shape)


def couple(
    place: Float[Array, "source 2"],
    fits: Sequence[GalaxyFit],
    beams: Beams,
    interaction: Interaction,
    profile: Profile,
    executor: Executor,
) -> Couplings:
    """Couplings of all sources at ``place`` [rad]."""
    reach = interaction.reach

    def work(task: tuple[list[int], list[int]]) -> tuple[list[int], Array]:
        own, others = task
        centre = place[own[0]]
        members = own + others
        blocks = fisher_blocks(
            [tuple(place[k] - centre) for k in members],
            [fits[k] for k in members],
            profile,
            interaction.short_plane(int(beams.nearest[own[0]])),
            len(own),
        )
        return members, blocks

    for node in range(len(beams.images)):
        interaction.short_plane(node)
    first, second = [np.zeros(0, int)], [np.zeros(0, int)]
    values = [np.zeros((0, PARAMETERS, PARAMETERS))]
    own = np.zeros((len(place), PARAMETERS, PARAMETERS))
    for members, blocks in executor.map(work, _boxes(place, reach)):
        index = np.array(members)
        apart = place[index][None, :] - place[index[: len(blocks)]][:, None]
        a, b = np.nonzero(np.hypot(apart[..., 0], apart[..., 1]) <= reach)
        own[index[: len(blocks)]] = np.einsum("iaib->iab", blocks[:, :, : len(blocks)])
        kept = b > a
        a, b = a[kept], b[kept]
        swapped = index[a] > index[b]
        block = blocks[a, :, b, :]
        first.append(np.where(swapped, index[b], index[a]))
        second.append(np.where(swapped, index[a], index[b]))
        values.append(np.where(swapped[:, None, None], block.swapaxes(1, 2), block))
    blocks = np.concatenate(values)
    flux = np.array([fit.flux for fit in fits])
    pairs = np.concatenate(first), np.concatenate(second)
    return Couplings(*pairs, blocks, own, interaction.far, flux)


def _boxes(place: Float[Array, "source 2"], side: float) -> Iterator[tuple[list[int], list[int]]]:
    """Give the sources of each square, and those of the four squares after it that touch it."""
    square = np.floor(place / side).astype(int)
    held: dict[tuple[int, int], list[int]] = {}
    for source, (a, b) in enumerate(square.tolist()):
        held.setdefault((a, b), []).append(source)
    for a, b in sorted(held):
        after = ((a, b + 1), (a + 1, b - 1), (a + 1, b), (a + 1, b + 1))
        yield held[a, b], [source for key in after for source in held.get(key, [])]


def joint_step(
    equations: Sequence[NormalEquations],
    couplings_: Couplings,
    flux: Float[Array, " source"],
    is_held: Bool[Array, " source"],
) -> Float[Array, "source 6"]:
    """Solve (F + DAMPING diag F) step = gradient by conjugate gradients, some sources held."""
    own = np.array([one.information for one in equations])
    gradient = np.array([one.gradient for one in equations])
    scale = np.sqrt(np.maximum(np.einsum("sii->si", own), 1e-300))
    own = own / (scale[:, :, None] * scale[:, None, :])
    own += np.where(is_held, HELD, DAMPING)[:, None, None] * np.eye(PARAMETERS)
    near = couplings_.blocks_with_diagonal(own, scale, flux)
    inverse = np.linalg.inv(own)

    def multiply(x: Float[Array, " n"]) -> Float[Array, " n"]:
        product = (near @ x).reshape(-1, PARAMETERS)
        flux = x.reshape(-1, PARAMETERS)[:, 0] / scale[:, 0]
        product[:, 0] += (couplings_.far @ flux) / scale[:, 0]
        return product.ravel()

    def precondition(x: Float[Array, " n"]) -> Float[Array, " n"]:
        return np.einsum("sij,sj->si", inverse, x.reshape(-1, PARAMETERS)).ravel()

    matrix = LinearOperator(near.shape, matvec=multiply, dtype=float)
    preconditioner = LinearOperator(near.shape, matvec=precondition, dtype=float)
    right = (gradient / scale).ravel()
    solution, _ = cg(matrix, right, rtol=_SOLVED, maxiter=_MOST_ITERATIONS, M=preconditioner)
    return solution.reshape(-1, PARAMETERS) / scale


@dataclass(frozen=True)
class Freedom:
    """What free neighbours mean for a source, by the Fisher matrix of its parameters.

    Parameters
    ----------
    held, free
        Covariance of the parameters with the neighbours held where they are, and with them free.
    shift
        What the parameters move by when neighbours follow, from where they are with neighbours held.
    """

    held: Float[Array, "6 6"]
    free: Float[Array, "6 6"]
    shift: Float[Array, " 6"]

    @property
    def share(self) -> float:
        """Part of the information on e that stays with the neighbours free."""
        held, free = (np.linalg.det(one[1:3, 1:3]) for one in (self.held, self.free))
        return math.sqrt(min(held / free, 1.0))


def freedom(
    source: int,
    others: Sequence[int],
    equations: Mapping[int, NormalEquations],
    couplings_: "BlockOf",
    sky_prior: tuple[Float[Array, " 6"], Float[Array, " 6"]],
) -> Freedom:
    """Tell what a source's neighbours add to its errors.

    ``sky_prior`` is the gradient and the precision of the prior that the source has in the sky but not in its
    measurement. Where the sky has settled the gradient of the likelihood is the opposite of that of the prior:
    without the prior the source moves by its covariance times that, farther if its neighbours may follow. What a
    source was held back by, its neighbours had taken.
    """
    group = [source, *others]
    count = len(group)
    pull, precision = sky_prior
    own = equations[source].information - np.diag(precision)
    matrix = np.zeros((count, PARAMETERS, count, PARAMETERS))
    for a, i in enumerate(group):
        shared = couplings_(i, i)
        # What a source's own facet tells beyond the baselines that it shares with others.
        beyond = (own if i == source else equations[i].information) - shared
        matrix[a, :, a, :] = shared + with_eigenvalue_floor(beyond, 0.0)
        for b, j in enumerate(group[:a]):
            block = couplings_(i, j)
            if block is not None:
                matrix[a, :, b, :] = block
                matrix[b, :, a, :] = block.T
    # Rounding may leave an eigenvalue of sources at one place below zero.
    held = regularised_inverse(matrix[0, :, 0, :])
    free = regularised_inverse(matrix.reshape(count * PARAMETERS, -1))[:PARAMETERS, :PARAMETERS]
    return Freedom(held, free, (held - free) @ pull)


class BlockOf:
    """Blocks by their sources, for their present fluxes."""

    def __init__(self, couplings_: Couplings, flux: Float[Array, " source"]) -> None:
        self._blocks, self._own = couplings_.at_flux(flux), couplings_.own_at_flux(flux)
        pairs = zip(couplings_.first.tolist(), couplings_.second.tolist(), strict=True)
        self._place = {pair: k for k, pair in enumerate(pairs)}

    def __call__(self, i: int, j: int) -> Float[Array, "6 6"] | None:
        """Block of rows of i and columns of j; None where they are not coupled."""
        if i == j:
            return self._own[i]
        if (k := self._place.get((i, j))) is not None:
            return self._blocks[k]
        if (k := self._place.get((j, i))) is not None:
            return self._blocks[k].T
        return None
