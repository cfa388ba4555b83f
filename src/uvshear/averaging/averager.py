"""A pass over an observation that averages it over cells of (u, v, w)."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from uvshear.averaging.blocks import blocks_of
from uvshear.averaging.cell_table import (
    BYTES_PER_CELL,
    CELLS_AT_A_TIME,
    Averages,
    CellTable,
    RowsToAverage,
)
from uvshear.averaging.cells import Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.averaging.sub_bands import SubBand
from uvshear.execution import Promise, Resources
from uvshear.interferometer.screening import screened
from uvshear.interferometer.visibilities import Visibilities


@dataclass(frozen=True)
class Group:
    """Samples that are averaged together where they lie in one cell: those of a sub-band and of a kind of dish pair."""

    band: SubBand
    pair: int


@dataclass(frozen=True)
class PartialSums:
    """Sums over a part of the visibilities, which can be sent to another process.

    Parameters
    ----------
    samples
        Number of samples with weight.
    tables
        Table of each group.
    """

    samples: int
    tables: dict[Group, CellTable]


Sink: TypeAlias = Callable[[Group, Averages], None]
"""Function that takes averages of a group, possibly several times."""

_Full: TypeAlias = list[Averages]
"""Averages of tables for which there was no more memory."""


class Averager:
    """Averages over cells, which are given to a function when they are complete or when the memory is full.

    In the second case later samples of the same cells are averaged on their own, and the result has more rows.

    Parameters
    ----------
    cells
        Sizes of the cells.
    sink
        Function that takes the averages.
    resources
        Workers, which share the sub-bands, and memory for the sums. Results depend on the memory if it is too small,
        and never on the workers.
    """

    def __init__(self, cells: Cells, sink: Sink, resources: Resources) -> None:
        self._cells, self._sink = cells, sink
        self._executor = resources.executor
        self._most = resources.memory / BYTES_PER_CELL
        self._tables: dict[Group, CellTable] = {}
        self._last: dict[Group, Promise[_Full]] = {}
        self._samples = 0

    def add(self, chunks: Iterable[Visibilities], pairs: DishPairs) -> None:
        """Add chunks of one array; the next ones are read while workers add the last ones.

        Samples that cannot be right are left out (``screening``).
        """
        for group, full in self._executor.map(_work, self._tasks(chunks, pairs)):
            for averages in full:
                self._sink(group, averages)

    def pass_on(self, group: Group, averages: Averages) -> None:
        """Pass averages on that are complete."""
        self._sink(group, averages)

    def sums(self) -> "PartialSums":
        """Return all sums that have not been passed on; the averager is not used any more."""
        return PartialSums(self._samples, self._tables)

    def merge(self, later: "PartialSums") -> None:
        """Add the sums over later visibilities, which are not used elsewhere any more."""
        self._samples += later.samples
        for group, table in later.tables.items():
            if (own := self._tables.get(group)) is None:
                self._tables[group] = table
                continue
            # While a table grows, its old memory is still in use.
            if 3 * own.room_with(len(table)) > self._most / len(self._tables) and len(own):
                self._pass_on(group, own)
            own.add_cells(table)

    @property
    def cells(self) -> int:
        """Number of cells whose averages have not been passed on."""
        return sum(map(len, self._tables.values()))

    def finish(self, on_cells: Callable[[int], None] | None = None) -> int:
        """Pass all remaining averages on, and return the number of samples that all averages are made of.

        ``on_cells`` is called now and then with the number of cells since the last call.
        """
        for group in sorted(self._tables, key=lambda group: (group.band.number, group.pair)):
            self._pass_on(group, self._tables[group], on_cells)
        return self._samples

    def _pass_on(
        self, group: Group, table: CellTable, on_cells: Callable[[int], None] | None = None
    ) -> None:
        left = len(table)
        for averages in self._executor.map(lambda make: make(), table.taken_in_parts()):
            self._sink(group, averages)
            if on_cells is not None:
                on_cells(min(CELLS_AT_A_TIME, left))
            left -= CELLS_AT_A_TIME

    def _tasks(self, chunks: Iterable[Visibilities], pairs: DishPairs) -> Iterator["_Task"]:
        for seen in blocks_of(map(screened, chunks)):
            self._samples += int(np.count_nonzero(seen.weights > 0))
            bands = SubBand.of_channels(seen.frequency)
            for pair, part in pairs.divided(seen).items():
                rows = RowsToAverage.from_visibilities(part)
                for band in bands:
                    group, done = Group(band, pair), Promise[_Full]()
                    table = self._tables.setdefault(group, CellTable(self._cells, band))
                    # Tables that come later have no influence, nor has the order in which workers finish.
                    most = self._most / len(self._tables)
                    yield _Task(group, table, rows, most, self._last.get(group), done)
                    self._last[group] = done


@dataclass(frozen=True)
class _Task:
    """Samples that are added to a table, after those of the previous task for this table."""

    group: Group
    table: CellTable
    rows: RowsToAverage
    most: float
    before: "Promise[_Full] | None"
    done: "Promise[_Full]"


def _work(task: _Task) -> tuple[Group, _Full]:
    if task.before is not None:
        task.before.value()
    task.done.keep(lambda: _added(task))
    return task.group, task.done.value()


def _added(task: _Task) -> _Full:
    full: _Full = []
    row = 0
    while (row := task.table.add(task.rows, row)) < len(task.rows):
        # While a table grows, its old memory is still in use.
        if 3 * task.table.room > task.most and len(task.table):
            full += task.table.taken()
        else:
            task.table.grow()
    return full
