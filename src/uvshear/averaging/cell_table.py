"""Sums over the samples in each cell of (u, v, w), and the averages that they give."""

from dataclasses import dataclass
from typing import Final, Self, TypeAlias

import numpy as np

from uvshear.averaging import kernels
from uvshear.averaging.cells import Cells
from uvshear.averaging.sub_bands import SubBand
from uvshear.errors import InputError
from uvshear.interferometer.averaged_rows import MOMENTS, AveragedRows
from uvshear.interferometer.visibilities import Visibilities
from uvshear.typing import Array, Complex, Float, Int

COLUMNS: Final = 16
"""Number of weighted sums of a cell: of 1, of the real and imaginary parts of the visibility, of three coordinates and
their six products, of the frequency, of Δν/ν, and of the time and the length of the integration."""

BYTES_PER_CELL: Final = 8 * COLUMNS + 8 + 2 * 4
"""Memory of a cell: its sums, its key, and two hashes."""

SMALLEST: Final = 2**12
"""Number of cells for which a table has room at first."""


@dataclass(frozen=True)
class Averages:
    """Averages over cells, as rows of one channel.

    Parameters
    ----------
    uvw
        Mean baselines, in metres at the frequency of the sub-band.
    stokes_i
        Mean visibilities [Jy].
    weights
        Sums of the weights [Jy^-2].
    time, interval
        Mean middle and mean length of the integrations [s].
    rows
        Frequencies, widths and second moments.
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
    """

    seen: Visibilities
    uvw: Float[Array, "row 3"]
    integrations: Float[Array, "row 2"]

    @classmethod
    def from_visibilities(cls, seen: Visibilities) -> Self:
        """Prepare some rows."""
        integrations, taken = np.zeros((len(seen), 2)), seen.integrations
        if taken is not None:
            integrations = np.column_stack([taken.time, taken.interval]).astype(float)
        return cls(seen, np.ascontiguousarray(seen.uvw, float), integrations)

    def __len__(self) -> int:
        return len(self.seen)


_State: TypeAlias = tuple[SubBand, Array, Array, Array]
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
        self._band, self._count = band, 0
        self._size = np.array([cells.uv, cells.w]) * band.metres
        self._reset(SMALLEST)

    def __getstate__(self) -> _State:
        """Leave out the memory that holds no cell, and the hashes."""
        return self._band, self._size, self._keys[: self._count], self._sums[: self._count]

    def __setstate__(self, state: _State) -> None:
        """Take over cells; hashes are worked out when others are added to them."""
        self._band, self._size, keys, sums = state
        self._keys, self._sums = keys, sums
        self._count, self._places = len(self._keys), np.empty(0, np.int32)

    def __len__(self) -> int:
        return self._count

    @property
    def room(self) -> int:
        """Number of cells for which there is memory."""
        return len(self._keys)

    def add(self, rows: RowsToAverage, first: int) -> int:
        """Add the samples of the sub-band from a row on, and return the first row for which there was no room."""
        seen = rows.seen
        chosen = self._band.channels(seen.frequency)
        if not len(chosen):
            return len(seen)
        self._check(seen, first)
        width = np.zeros(len(seen.frequency)) if seen.width is None else seen.width
        frequency = seen.frequency[chosen]
        row, self._count = kernels.add_samples(
            first,
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

    def taken(self) -> Averages:
        """Return the averages of all cells, in the order in which these were met, and empty the table."""
        keys, sums = self._keys[: self._count], self._sums[: self._count]
        self._reset(SMALLEST)
        weight = sums[:, 0]
        mean = sums / weight[:, None]
        indices = np.empty((len(keys), 3))
        kernels.cell_indices(keys, indices)
        size = self._size[[0, 0, 1]]
        products = np.stack([mean[:, 3 + a] * mean[:, 3 + b] for a, b in MOMENTS], axis=-1)
        covariance = mean[:, 6:12] - products
        # Rounding must not make variances negative.
        for number, (a, b) in enumerate(MOMENTS):
            if a == b:
                covariance[:, number] = np.maximum(covariance[:, number], 0.0)
        frequency = mean[:, 12] * self._band.frequency
        return Averages(
            uvw=indices * size + mean[:, 3:6],
            stokes_i=(mean[:, 1] + 1j * mean[:, 2]).astype(np.complex64),
            weights=weight.copy(),
            time=mean[:, 14],
            interval=mean[:, 15],
            rows=AveragedRows(frequency, mean[:, 13] * frequency, covariance),
        )

    def _reset(self, room: int) -> None:
        self._count = 0
        self._keys = np.empty(room, np.int64)
        self._sums = np.empty((room, COLUMNS))
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
