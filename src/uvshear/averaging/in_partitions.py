"""Averages of observations in files, one range of rows after the other or many at a time, with the same result."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

from uvshear.averaging.averager import Averager, Group, PartialSums
from uvshear.averaging.cell_table import BYTES_PER_CELL, Averages
from uvshear.averaging.cells import Cells
from uvshear.averaging.dish_pairs import DishPairs
from uvshear.errors import InputError
from uvshear.execution import SERIAL, Resources
from uvshear.interferometer.origin import origin_of
from uvshear.interferometer.partitions import HasRows, RowRange, partitions_of
from uvshear.interferometer.visibilities import Observation, Visibilities

SAMPLES: Final = 2**22
"""Number of samples of a partition, which depends on neither the executor nor the number of workers: sums over a
partition are added to those over the earlier ones, and the last bits depend on where partitions begin. In a single
process 58 million samples take 9.8 s of processor time in 14 partitions, and 10.4 s in four."""


@dataclass(frozen=True)
class _Setting:
    cells: Cells
    resources: Resources


@dataclass(frozen=True)
class _Partition:
    """Rows of a part of the observation, and the kinds of its pairs of dishes."""

    part: int
    rows: RowRange
    pairs: DishPairs


_Full: TypeAlias = list[tuple[Group, Averages]]
"""Averages for whose sums there was no more memory."""


def add_in_partitions(
    averager: Averager,
    parts: Sequence[tuple[HasRows, DishPairs]],
    cells: Cells,
    resources: Resources,
    on_samples: Callable[[float], None] | None = None,
) -> None:
    """Add all parts of an observation to the averages.

    Each worker averages a partition. On a single machine the partitions are read ahead, one after the other, and on a
    cluster each worker reads its own. The sums of partitions are always added in the order of their rows.
    """
    most = int(min(SAMPLES, resources.memory / (6 * BYTES_PER_CELL)))
    partitions = [
        _Partition(number, rows, pairs)
        for number, (part, pairs) in enumerate(parts)
        for rows in partitions_of(part, most)
    ]
    # Sums over a partition are held beside those over the earlier ones.
    share = resources.memory / min(2, len(partitions))
    setting = _Setting(cells, Resources(SERIAL, share))
    found = resources.executor.in_partitions(_read, _averaged, setting, partitions)
    samples = [0] * len(parts)
    for partition, (full, sums) in zip(partitions, found, strict=True):
        for group, averages in full:
            averager.pass_on(group, averages)
        averager.merge(sums)
        samples[partition.part] += sums.samples
        if on_samples is not None:
            on_samples(partition.rows.samples)
    for (part, _), count in zip(parts, samples, strict=True):
        if not count:
            raise InputError(
                f"{origin_of(part).name}: no visibility carries weight; there is nothing to average"
            )


def samples_to_average(part: Observation) -> Iterator[Visibilities]:
    """Read a part of an observation, and refuse one that holds averages."""
    for seen in part.chunks():
        if seen.averages is not None:
            raise InputError(
                f"{origin_of(part).name}: holds averages already; average the set that it was made from"
            )
        yield seen


def _read(partition: _Partition) -> list[Visibilities]:
    return list(samples_to_average(partition.rows))


def _averaged(
    setting: _Setting, partition: _Partition, chunks: list[Visibilities]
) -> tuple[_Full, PartialSums]:
    full: _Full = []
    averager = Averager(setting.cells, lambda *averages: full.append(averages), setting.resources)
    averager.add(chunks, partition.pairs)
    return full, averager.sums()
