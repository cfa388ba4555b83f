"""Couplings between the parameters of sources: blocks of their joint Fisher matrix.

The blocks between sources only have to give an ascent direction. They are therefore computed from the shorter half of
the baselines and end at some distance, beyond which the plateau of the beam couples fluxes alone.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from uvshear.shapes.normal_equations import fisher_blocks
from uvshear.shapes.template import PARAMETERS
from uvshear.typing import Array, Float, Int

if TYPE_CHECKING:
    from uvshear.extraction.converged.moving_sky import MovingSky, SkyCrew
    from uvshear.extraction.converged.sky_state import SkyState


@dataclass(frozen=True)
class Couplings:
    """Joint Fisher matrix of the sources, by its blocks.

    Parameters
    ----------
    first, second
        Pairs of neighbouring sources, each pair once (first < second).
    blocks
        Block of each pair, rows of the first and columns of the second.
    own
        Own block of each source from the same baselines, with which the matrix is positive.
    far
        Coupling of the fluxes of sources that are far from one another [Jy^-2].
    flux
        Fluxes of the sources for which the blocks were computed [Jy].
    """

    first: Int[Array, " pair"]
    second: Int[Array, " pair"]
    blocks: Float[Array, "pair 6 6"]
    own: Float[Array, "source 6 6"]
    far: sparse.csr_matrix
    flux: Float[Array, " source"]

    def at_flux(self, flux: Float[Array, " source"]) -> Float[Array, "pair 6 6"]:
        """Return the blocks for other fluxes [Jy], to which all responses but that to the flux are proportional."""
        ratio = self._grown(flux)
        return self.blocks * (ratio[self.first][:, :, None] * ratio[self.second][:, None, :])

    def own_at_flux(self, flux: Float[Array, " source"]) -> Float[Array, "source 6 6"]:
        """Return the own blocks for other fluxes [Jy]."""
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
        """Return the matrix of all blocks, rows and columns divided by ``scale``; ``own`` are divided already."""
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


def couple(now: "SkyState", crew: "SkyCrew") -> Couplings:
    """Compute the couplings of all sources with their present parameters."""
    interaction, fits = now.interaction, now.fits
    place, reach = interaction.plan.centres, interaction.reach
    interaction.work_out_planes()
    first, second = [np.zeros(0, int)], [np.zeros(0, int)]
    values = [np.zeros((0, PARAMETERS, PARAMETERS))]
    own = np.zeros((len(place), PARAMETERS, PARAMETERS))
    for found in crew.map(_blocks, _boxes(place, reach)):
        own[found.sources] = found.own
        first.append(found.first)
        second.append(found.second)
        values.append(found.blocks)
    blocks = np.concatenate(values)
    flux = np.array([fit.flux for fit in fits])
    pairs = np.concatenate(first), np.concatenate(second)
    return Couplings(*pairs, blocks, own, interaction.far, flux)


@dataclass(frozen=True)
class _OfBox:
    """Blocks of the sources of a box among one another and with its neighbours, as in :class:`Couplings`."""

    sources: Int[Array, " own"]
    own: Float[Array, "own 6 6"]
    first: Int[Array, " pair"]
    second: Int[Array, " pair"]
    blocks: Float[Array, "pair 6 6"]


def _blocks(sky: "MovingSky", task: tuple[list[int], list[int]]) -> _OfBox:
    """Return the blocks of a box whose sources and neighbours are given."""
    own, others = task
    now, members = sky.now, np.array(own + others)
    place, reach = now.interaction.plan.centres[members], now.interaction.reach
    apart = place[None, :] - place[: len(own), None]
    blocks = fisher_blocks(
        [tuple(of_member) for of_member in place - place[0]],
        [now.fits[k] for k in members],
        now.profile,
        now.interaction.short_plane_around(own[0]),
        len(own),
    )
    a, b = np.nonzero(np.hypot(apart[..., 0], apart[..., 1]) <= reach)
    kept = b > a
    a, b = a[kept], b[kept]
    swapped = members[a] > members[b]
    block = blocks[a, :, b, :]
    return _OfBox(
        sources=members[: len(own)],
        own=np.einsum("iaib->iab", blocks[:, :, : len(own)]).copy(),
        first=np.where(swapped, members[b], members[a]),
        second=np.where(swapped, members[a], members[b]),
        blocks=np.where(swapped[:, None, None], block.swapaxes(1, 2), block),
    )


def _boxes(place: Float[Array, "source 2"], side: float) -> Iterator[tuple[list[int], list[int]]]:
    """Yield the sources of each square, and those of the four squares after it that touch it."""
    square = np.floor(place / side).astype(int)
    held: dict[tuple[int, int], list[int]] = {}
    for source, (a, b) in enumerate(square.tolist()):
        held.setdefault((a, b), []).append(source)
    for a, b in sorted(held):
        after = ((a, b + 1), (a + 1, b - 1), (a + 1, b), (a + 1, b + 1))
        yield held[a, b], [source for key in after for source in held.get(key, [])]


class CouplingBlocks:
    """Blocks of the Fisher matrix for the present fluxes, found by their sources."""

    def __init__(self, couplings: Couplings, flux: Float[Array, " source"]) -> None:
        self._blocks, self._own = couplings.at_flux(flux), couplings.own_at_flux(flux)
        pairs = zip(couplings.first.tolist(), couplings.second.tolist(), strict=True)
        self._place = {pair: k for k, pair in enumerate(pairs)}

    def between(self, i: int, j: int) -> Float[Array, "6 6"] | None:
        """Return the block with the rows of i and the columns of j; None where they are not coupled."""
        if i == j:
            return self._own[i]
        if (k := self._place.get((i, j))) is not None:
            return self._blocks[k]
        if (k := self._place.get((j, i))) is not None:
            return self._blocks[k].T
        return None
