"""A pass over an observation that averages it over cells of (u, v, w)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self, TypeAlias

import numpy as np

from uvshear.averaging.cell_table import BYTES_PER_CELL, Averages, CellTable
from uvshear.averaging.cells import Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.averaging.sub_bands import SubBand
from uvshear.execution import Resources
from uvshear.interferometer.accumulate import Accumulator
from uvshear.interferometer.visibilities import Visibilities


@dataclass(frozen=True)
class Group:
    """Samples that are averaged together where they lie in one cell: those of a sub-band and of a kind of dish pair."""

    band: SubBand
    pair: int


Sink: TypeAlias = Callable[[Group, Averages], None]
"""Function that takes averages of a group, once or more often."""


class Averager(Accumulator[int]):
    """Averages over cells, which are given to a function when they are complete or when the memory is full.

    In the second case later samples of the same cells are averaged on their own, and the result has more rows.

    Parameters
    ----------
    cells
        Sizes of the cells.
    pairs
        Kinds of pairs of dishes.
    sink
        Function that takes the averages.
    resources
        Workers, which share the sub-bands, and memory for the sums. Results depend on the memory if it is too small,
        and never on the workers.
    """

    def __init__(self, cells: Cells, pairs: DishPairs, sink: Sink, resources: Resources) -> None:
        self._cells, self._pairs, self._sink = cells, pairs, sink
        self._executor = resources.executor
        self._most = resources.memory / BYTES_PER_CELL
        self._tables: dict[Group, CellTable] = {}
        self._samples = 0

    def add(self, seen: Visibilities) -> None:
        """Add a chunk."""
        self._samples += int(np.count_nonzero(seen.weights > 0))
        parts = self._pairs.divided(seen)
        bands = SubBand.of_channels(seen.frequency)
        waiting = {Group(band, pair): 0 for band in bands for pair in parts}
        for group in waiting:
            self._tables.setdefault(group, CellTable(self._cells, group.band))

        def work(group: Group) -> int:
            return self._tables[group].add(parts[group.pair], waiting[group])

        while waiting:
            groups = list(waiting)
            for group, row in zip(groups, list(self._executor.map(work, groups)), strict=True):
                if row == len(parts[group.pair]):
                    del waiting[group]
                else:
                    waiting[group] = row
                    self._make_room(group)

    def merge(self, later: Self) -> None:
        """Add the sums over later visibilities."""
        self._samples += later._samples
        for group, table in later._tables.items():
            self._tables.setdefault(group, CellTable(self._cells, group.band)).add_cells(table)

    def result(self) -> int:
        """Give away all averages, and return the number of samples that they are made of."""
        for group in sorted(self._tables, key=lambda group: (group.band.number, group.pair)):
            if len(table := self._tables[group]):
                self._sink(group, table.taken())
        return self._samples

    def _make_room(self, group: Group) -> None:
        table = self._tables[group]
        # While a table grows, its old memory is still in use.
        needed = sum(each.room for each in self._tables.values()) + 2 * table.room
        if needed > self._most and len(table):
            self._sink(group, table.taken())
        else:
            table.grow()
