"""Sums over the samples in each cell of (u, v, w), and the averages that they give."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Final, Self, TypeAlias

import numpy as np

from uvshear.averaging import cell_sums, kernels
from uvshear.averaging.cells import Cells
from uvshear.averaging.nodes.cell_nodes import Nodes
from uvshear.averaging.sub_bands import SubBand
from uvshear.errors import InputError
from uvshear.interferometer.averaged_rows import FOURTH, SECOND, AveragedRows
from uvshear.interferometer.visibilities import Visibilities
from uvshear.typing import Array, Complex, Float, Int

BYTES_PER_CELL: Final = 8 * cell_sums.COLUMNS + 8 + 2 * 4
"""Memory of a cell: its sums, its key, and two hashes."""

CELLS_AT_A_TIME: Final = 2**17
"""Number of cells whose averages are made together, which take some 200 MB."""

SMALLEST: Final = 2**12
"""Number of cells for which a table has room at first."""


@dataclass(frozen=True)
class Averages:
    """Averages over cells, as rows of one channel, each of which is a node of a cell (``nodes``).

    Parameters
    ----------
    uvw
        Places of the nodes, in metres at the frequency of the sub-band.
    stokes_i
        Visibilities of the nodes [Jy].
    weights
        Weights of the nodes, which add up to the weight of the samples in their cell [Jy^-2].
    time, interval
        Mean middle and mean length of the integrations of the cell [s].
    rows
        Frequencies, widths, second moments and forms of fourth degree.
    """

    uvw: Float[Array, "row 3"]
    stokes_i: Complex[Array, " row"]
    weights: Float[Array, " row"]
    time: Float[Array, " row"]
    interval: Float[Array, " row"]
    rows: AveragedRows

    def __len__(self) -> int:
        return len(self.uvw)


@dataclass(frozen=True)
class RowsToAverage:
    """Visibilities as the kernels take them.

    Parameters
    ----------
    seen
        The visibilities.
    uvw
        Baselines [m].
    integrations
        Time and length of each integration [s]; 0 where they are not known.
    order
        Rows, one baseline after the other where these are known. Successive integrations of a baseline often lie in the
        same cells.
    """

    seen: Visibilities
    uvw: Float[Array, "row 3"]
    integrations: Float[Array, "row 2"]
    order: Int[Array, " row"]

    @classmethod
    def from_visibilities(cls, seen: Visibilities) -> Self:
        """Prepare some rows."""
        integrations, taken = np.zeros((len(seen), 2)), seen.integrations
        order = np.arange(len(seen))
        if taken is not None:
            integrations = np.column_stack([taken.time, taken.interval]).astype(float)
            order = np.lexsort(taken.antennas.T)
        return cls(seen, np.ascontiguousarray(seen.uvw, float), integrations, order)

    def __len__(self) -> int:
        return len(self.seen)


_State: TypeAlias = tuple[SubBand, Cells, Array, Array]
"""A table on its way to another process: its sub-band, the sizes of its cells, their keys and their sums."""


class CellTable:
    """Sums over the samples of a sub-band, cell by cell.

    Parameters
    ----------
    cells
        Sizes of the cells.
    band
        The sub-band.
    """

    _keys: Int[Array, " cell"]
    _sums: Float[Array, "cell sum"]
    _places: Int[Array, " hash"]

    def __init__(self, cells: Cells, band: SubBand) -> None:
        self._band, self._cells, self._count = band, cells, 0
        self._reset(SMALLEST)

    def __getstate__(self) -> _State:
        """Leave out the memory that holds no cell, and the hashes."""
        return self._band, self._cells, self._keys[: self._count], self._sums[: self._count]

    def __setstate__(self, state: _State) -> None:
        """Take over cells; hashes are worked out when others are added to them."""
        self._band, self._cells, keys, sums = state
        self._keys, self._sums = keys, sums
        self._count, self._places = len(self._keys), np.empty(0, np.int32)

    def __len__(self) -> int:
        return self._count

    @property
    def _size(self) -> Float[Array, " 2"]:
        """Sizes along (u, v) and w [m], at the middle of the band."""
        return np.array([self._cells.uv, self._cells.w]) * self._band.metres

    @property
    def room(self) -> int:
        """Number of cells for which there is memory."""
        return len(self._keys)

    def add(self, rows: RowsToAverage, first: int) -> int:
        """Add the samples of the sub-band, from a place in the order of the rows on.

        Returns the first place for which there was no room.
        """
        seen = rows.seen
        chosen = self._band.channels(seen.frequency)
        if not len(chosen):
            return len(seen)
        self._check(seen, first)
        width = np.zeros(len(seen.frequency)) if seen.width is None else seen.width
        frequency = seen.frequency[chosen]
        row, self._count = kernels.add_samples(
            first,
            rows.order,
            rows.uvw,
            rows.integrations,
            seen.stokes_i,
            seen.weights,
            chosen,
            frequency / self._band.frequency,
            width[chosen] / frequency,
            self._size,
            self._places,
            self._keys,
            self._sums,
            self._count,
        )
        return int(row)

    def add_cells(self, other: Self) -> None:
        """Add the sums of another table of the same cells, for which there must be room (:meth:`room_with`)."""
        if not len(self._places):
            self._resize(self.room_with(0))
        while self._count + len(other) > self.room:
            self.grow()
        self._count = kernels.add_cells(
            other._keys[: len(other)],
            other._sums[: len(other)],
            self._places,
            self._keys,
            self._sums,
            self._count,
        )

    def room_with(self, more: int) -> int:
        """Return the number of cells for which there is memory once this number of cells has been added."""
        room = SMALLEST
        while room < self._count + more:
            room *= 2
        return max(room, self.room)

    def grow(self) -> None:
        """Take twice as much memory."""
        self._resize(2 * self.room)

    def _resize(self, room: int) -> None:
        keys, sums, count = self._keys, self._sums, self._count
        self._reset(room)
        self._keys[:count], self._sums[:count] = keys[:count], sums[:count]
        self._count = count
        kernels.rehash(self._keys, count, self._places)

    def taken(self) -> Iterator[Averages]:
        """Empty the table, and yield the averages of all cells in the order in which these were met."""
        return (make() for make in self.taken_in_parts())

    def taken_in_parts(self) -> Iterator[Callable[[], Averages]]:
        """Do the same with functions that make averages, which may be called side by side."""
        keys, sums = self._keys[: self._count], self._sums[: self._count]
        self._reset(SMALLEST)
        for start in range(0, len(keys), CELLS_AT_A_TIME):
            some = slice(start, start + CELLS_AT_A_TIME)
            yield partial(self._averages, keys[some], sums[some])

    def _averages(self, keys: Int[Array, " cell"], sums: Float[Array, "cell sum"]) -> Averages:
        indices = np.empty((len(keys), 3))
        kernels.cell_indices(keys, indices)
        # Errors of third order then have opposite signs in neighbouring cells.
        turned = indices.sum(axis=1) % 2 == 1
        nodes = Nodes.of_cells(sums, self._cells.smallest_scatter, turned)
        size = self._size[[0, 0, 1]]
        weight, frequency = sums[:, cell_sums.WEIGHT], nodes.frequency * self._band.frequency
        width, time, interval = (
            (sums[:, column] / weight)[nodes.cell]
            for column in (cell_sums.RELATIVE_WIDTH, cell_sums.TIME, cell_sums.INTERVAL)
        )
        to_second, to_fourth = (
            np.array([np.prod(size[list(place)]) for place in places])
            for places in (SECOND, FOURTH)
        )
        return Averages(
            uvw=(indices[nodes.cell] + nodes.place) * size,
            stokes_i=nodes.stokes_i.astype(np.complex64),
            weights=nodes.share * weight[nodes.cell],
            time=time,
            interval=interval,
            rows=AveragedRows(
                frequency,
                width * frequency,
                (nodes.second * to_second).astype(np.float32),
                (nodes.fourth * to_fourth).astype(np.float32),
                size,
            ),
        )

    def _reset(self, room: int) -> None:
        self._count = 0
        self._keys = np.empty(room, np.int64)
        self._sums = np.empty((room, cell_sums.COLUMNS))
        self._places = np.full(2 * room, -1, np.int32)

    def _check(self, seen: Visibilities, first: int) -> None:
        if first:
            return
        farthest, farthest_w = kernels.FARTHEST
        longest = np.abs(seen.uvw).max(axis=0, initial=0.0) * self._band.highest
        allowed = self._size * (farthest, farthest_w)
        if max(longest[0], longest[1]) > allowed[0] or longest[2] > allowed[1]:
            raise InputError(
                "the cells are too small for the longest baselines; average for a smaller field or less accurately"
            )
