"""Nodes of all cells of a table."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from uvshear.averaging.nodes.kernels import count_nodes, find_nodes
from uvshear.typing import Array, Bool, Complex, Float, Int


@dataclass(frozen=True)
class Nodes:
    """Nodes of all cells, in units of the cells.

    Parameters
    ----------
    cell
        Numbers of their cells, which ascend.
    place
        Distance from the middle of the cell along u, v and w.
    share
        Weight over that of the cell.
    stokes_i
        Visibilities [Jy].
    frequency
        Frequencies over that in the middle of the sub-band.
    second, fourth
        Second moments of the samples for which the node stands, and what is lost beyond them (``AveragedRows``).
    """

    cell: Int[Array, " node"]
    place: Float[Array, "node 3"]
    share: Float[Array, " node"]
    stokes_i: Complex[Array, " node"]
    frequency: Float[Array, " node"]
    second: Float[Array, "node 6"]
    fourth: Float[Array, "node 15"]

    @classmethod
    def of_cells(
        cls,
        sums: Float[Array, "cell sum"],
        smallest_scatter: float,
        turned: Bool[Array, " cell"],
    ) -> Self:
        """Find the nodes from the sums over the cells (``cell_sums``).

        Parameters
        ----------
        sums
            Weighted sums.
        smallest_scatter
            Largest variance along a direction that gets no node of its own, in units of the squared size of a cell.
        turned
            Whether triangles and tetrahedra are turned to the opposite side.
        """
        counts = np.empty(len(sums), np.int64)
        count_nodes(sums, smallest_scatter, counts)
        rows = int(counts.sum())
        place, share, vis = np.empty((rows, 3)), np.empty(rows), np.empty((rows, 2))
        frequency, second, fourth = np.empty(rows), np.empty((rows, 6)), np.empty((rows, 15))
        cell = np.empty(rows, np.int64)
        find_nodes(
            sums, smallest_scatter, turned, place, share, vis, frequency, second, fourth, cell
        )
        return cls(cell, place, share, vis.view(complex)[:, 0], frequency, second, fourth)
