"""The image of all changes of the sky since the last major cycle, convolved with the beam."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.execution.shared_memory import shared_zeros
from uvshear.extraction.converged.beams import SIZE
from uvshear.extraction.converged.interaction import WINDOW, Interaction
from uvshear.typing import Array, Complex, Float, Int

BLOCK = WINDOW
"""Side of the blocks in which an image is copied [coarse pixels]."""


@dataclass(frozen=True)
class Changes:
    """Content of an image of changes, without the places that no source reaches.

    Parameters
    ----------
    corners
        First pixel of each block in which there may be something.
    blocks
        Pixels of these blocks; those beyond the edge of the image are zero.
    plateau
        Far couplings of each source times the changes of the fluxes.
    """

    corners: Int[Array, "block 2"]
    blocks: Float[Array, "block l m"]
    plateau: Float[Array, " source"]


class ChangeImage:
    """Dirty image of the change of the sky since the last major cycle; empty at first.

    It is updated in place, because a copy would cost more than most changes; a caller that keeps it takes a
    :meth:`copy`.

    Parameters
    ----------
    interaction
        The beam of the last major cycle.
    """

    def __init__(self, interaction: Interaction) -> None:
        self._interaction = interaction
        self._places = interaction.plan.place // 2
        margin = SIZE // 2
        self._origin = self._places.min(axis=0) - margin
        shape = self._places.max(axis=0) + margin + 1 - self._origin
        # Zeros that nobody writes take no memory: places without sources cost nothing.
        self._pixels = shared_zeros(shape.tolist(), np.float32)
        self._plateau = shared_zeros((len(self._places),), np.float64)
        self._is_empty = True

    def copy(self) -> Self:
        """Return an independent image of the same changes."""
        other = type(self)(self._interaction)
        if self._is_empty:
            return other
        other._is_empty = False
        for corner in self._corners():
            block = _block_at(corner)
            other._pixels[block] = self._pixels[block]
        other._plateau[:] = self._plateau
        return other

    def changes(self) -> Changes:
        """Return the content of the image."""
        corners = np.zeros((0, 2), int) if self._is_empty else self._corners()
        blocks = np.zeros((len(corners), BLOCK, BLOCK), np.float32)
        for block, corner in zip(blocks, corners, strict=True):
            found = self._pixels[_block_at(corner)]
            block[: found.shape[0], : found.shape[1]] = found
        return Changes(corners, blocks, self._plateau.copy())

    @classmethod
    def from_changes(cls, interaction: Interaction, changes: Changes) -> Self:
        """Return an image with this content, for the interaction for which the changes were rendered."""
        image = cls(interaction)
        if len(changes.corners) == 0:
            return image
        image._is_empty = False
        for block, corner in zip(changes.blocks, changes.corners, strict=True):
            there = image._pixels[_block_at(corner)]
            there[:] = block[: there.shape[0], : there.shape[1]]
        image._plateau[:] = changes.plateau
        return image

    def _corners(self) -> Int[Array, "block 2"]:
        """First pixels of the blocks that the changes of sources reach."""
        first = (self._places - self._origin - WINDOW // 2) // BLOCK
        corners = [first + corner for corner in ((0, 0), (0, 1), (1, 0), (1, 1))]
        return np.unique(np.concatenate(corners), axis=0) * BLOCK

    def add(self, source: int, change: Float[Array, "l m"]) -> None:
        """Add the rendered change of a source."""
        for strip in self.strips_of(source):
            self.add_to_strip(strip, source, change)
        self._is_empty = False

    def strips_of(self, source: int) -> range:
        """Numbers of the strips of ``WINDOW`` rows to which the change of a source is added."""
        first = int(self._places[source][0] - self._origin[0]) - WINDOW // 2
        return range(first // WINDOW, (first + WINDOW - 1) // WINDOW + 1)

    def add_to_strip(self, strip: int, source: int, change: Float[Array, "l m"]) -> None:
        """Add the rows of a change that lie in one strip; different strips may be added to at the same time."""
        i, j = self._places[source] - self._origin - WINDOW // 2
        first, last = max(i, strip * WINDOW), min(i + WINDOW, (strip + 1) * WINDOW)
        self._pixels[first:last, j : j + WINDOW] += change[first - i : last - i]

    def set_flux_changes(self, changes: Float[Array, " source"]) -> None:
        """Set the change of every source's flux since the last major cycle [Jy], once all changes were added."""
        # Changes may have been added by copies of this process.
        self._is_empty = False
        self._plateau[:] = self._interaction.far @ changes

    def subtract_from(self, facet: Complex[Array, " cell"], source: int) -> None:
        """Subtract all changes, including those of the source, from its residual facet (not yet recentred)."""
        cutout = self._interaction.plan.cutouts[source]
        half = cutout.size // 2
        i, j = self._places[source] - self._origin - half // 2
        cutout.add_coarse(self._pixels[i : i + half, j : j + half], -1.0, facet)
        if cutout.shortest <= 0:
            facet[cutout.origin] -= self._plateau[source]


def _block_at(corner: Int[Array, " 2"]) -> tuple[slice, slice]:
    i, j = corner.tolist()
    return slice(i, i + BLOCK), slice(j, j + BLOCK)
