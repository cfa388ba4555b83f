"""Visibilities of an MSv4 partition, read a block of times and baselines at a time."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from uvshear.errors import InputError
from uvshear.interferometer.visibilities import Integrations
from uvshear.io.correlated_rows import BYTES_PER_ROW, BYTES_PER_SAMPLE, CorrelatedRows, hands_slice
from uvshear.io.msv4.data_groups import CORRELATED_DIMENSIONS
from uvshear.io.msv4.opening import Dataset, open_group, zarr_errors
from uvshear.io.msv4.partition import EXPOSURE, INTERVAL, WEIGHT_OF_SIGMA, Partition
from uvshear.typing import Array, Bool, Float, Int

HELD: Final = 8
"""Largest size of the zarr chunks that are read at once, as a multiple of the size of the blocks that are passed on.

A zarr chunk holds several times and can only be decompressed as a whole. With blocks of 32 MB (``memory``), chunks of
up to 256 MB, such as those that xradio writes, are read once and then divided. Larger ones are decompressed several
times.
"""


@dataclass(frozen=True)
class BlockChoice:
    """What is to be read from a partition.

    Parameters
    ----------
    steps
        Which times are read.
    antennas
        Numbers of the antennas of each baseline.
    weights
        Variable of weights, or of sigma.
    subtracted
        Variable of a model that is subtracted from the visibilities; None for none.
    heeds_flags
        Whether flagged visibilities are left out.
    sign
        Factor of UVW.
    """

    steps: Bool[Array, " step"]
    antennas: Int[Array, "baseline 2"]
    weights: str
    subtracted: str | None
    heeds_flags: bool
    sign: float


def read_blocks(partition: Partition, choice: BlockChoice, memory: int) -> Iterator[CorrelatedRows]:
    """Read the chosen times once, in blocks that take about ``memory`` bytes while they are combined."""
    with open_group(partition.group) as group:
        reader = _BlockReader(group, partition, choice)
        rows = rows_per_block(partition, memory)
        for steps, baselines in reader.pieces(rows, HELD * memory):
            found = reader.read(steps, baselines)
            for start in range(0, len(found), rows):
                yield found.select(slice(start, start + rows))


def rows_per_block(partition: Partition, memory: int) -> int:
    """Return the number of rows whose buffers fill ``memory`` bytes."""
    samples = len(partition.setup.channels) * len(partition.setup.correlations)
    return max(1, memory // (BYTES_PER_SAMPLE * samples + BYTES_PER_ROW))


class _BlockReader:
    """One pass over an open group."""

    def __init__(self, group: Dataset, partition: Partition, choice: BlockChoice) -> None:
        self.group, self.partition, self.choice = group, partition, choice
        self.names = partition.variables
        self.hands = hands_slice(partition.setup.hands)

    def pieces(self, rows: int, most: int) -> Iterator[tuple[slice, slice]]:
        """Yield the times and the baselines that are read together."""
        baselines = len(self.choice.antennas)
        steps = self._steps_together(max(1, rows // max(1, baselines)), most)
        across = max(1, rows if steps == 1 else baselines)
        for start in range(0, len(self.choice.steps), steps):
            (wanted,) = np.nonzero(self.choice.steps[start : start + steps])
            if not len(wanted):
                continue
            times = slice(start + int(wanted[0]), start + int(wanted[-1]) + 1)
            for first in range(0, baselines, across):
                yield times, slice(first, min(first + across, baselines))

    def read(self, steps: slice, baselines: slice) -> CorrelatedRows:
        """Read the rows of some times and baselines: those that are chosen and that are not padding."""
        place = {"time": steps, "baseline_id": baselines}
        counts = (steps.stop - steps.start, baselines.stop - baselines.start)
        uvw = self._numbers(self.names.uvw, place, ("time", "baseline_id", "uvw_label")).astype(
            float
        )
        interval = self._interval(place, counts)
        chosen = np.repeat(self.choice.steps[steps], counts[1]).reshape(counts)
        chosen &= ~self._is_padding(uvw, place)
        setup = self.partition.setup
        shape = (*counts, len(setup.channels), len(setup.hands))
        correlations = self._visibilities(self.names.visibilities, place, shape)
        if self.choice.subtracted is not None:
            correlations = correlations - self._visibilities(self.choice.subtracted, place, shape)
        rows = Integrations(
            np.tile(self.choice.antennas[baselines], (counts[0], 1)),
            np.repeat(self.partition.timeline.time[steps], counts[1]),
            interval.ravel(),
        )
        found = CorrelatedRows(
            self.choice.sign * uvw.reshape(-1, 3),
            rows,
            correlations.reshape(-1, *shape[2:]),
            self._weights(place, shape).reshape(-1, *shape[2:]),
            self._flags(place, shape).reshape(-1, *shape[2:]),
        )
        return found if chosen.all() else found.select(chosen.ravel())

    def _steps_together(self, fitting: int, most: int) -> int:
        """Return how many times are read together: those of whole zarr chunks, unless these are too large."""
        found = self.group[self.names.visibilities]
        parts = found.encoding.get("chunks")
        if not parts or len(parts) != found.ndim:
            return fitting
        part = int(parts[found.dims.index("time")])
        if part <= fitting:
            return max(1, fitting // part) * part
        samples = len(self.choice.antennas) * len(self.partition.setup.channels)
        size = 13 * samples * len(self.partition.setup.hands)  # 8 of data, 4 of weight, 1 of flag
        return part if part * size <= most else fitting

    def _numbers(self, name: str, place: dict[str, slice], dimensions: tuple[str, ...]) -> Array:
        """Read a part of a variable, with an axis of length 1 for each dimension that it does not have."""
        found = self.group[name]
        taken = {axis: part for axis, part in place.items() if axis in found.dims}
        if "polarization" in found.dims:
            taken["polarization"] = self.hands
        ordered = [axis for axis in dimensions if axis in found.dims]
        with zarr_errors(self.partition.group, name):
            # xarray would read the elements one by one if it were to transpose what is not read yet.
            values = np.asarray(found.isel(taken).values)
        values = values.transpose([found.dims.index(axis) for axis in ordered])
        present = iter(values.shape)
        return values.reshape([next(present) if axis in ordered else 1 for axis in dimensions])

    def _visibilities(self, name: str, place: dict[str, slice], shape: tuple[int, ...]) -> Array:
        values = self._numbers(name, place, CORRELATED_DIMENSIONS)
        if values.shape != shape:
            raise InputError(
                f"{self.partition.group}: {name} has a part of shape {values.shape}; {shape} is needed"
            )
        return values

    def _flags(self, place: dict[str, slice], shape: tuple[int, ...]) -> Bool[Array, "..."]:
        name = self.names.flags
        if not self.choice.heeds_flags or name not in self.group.variables:
            return np.zeros(shape, bool)
        # Flags may be bit masks, in which each bit stands for one reason.
        return np.broadcast_to(self._numbers(name, place, CORRELATED_DIMENSIONS) != 0, shape)

    def _weights(self, place: dict[str, slice], shape: tuple[int, ...]) -> Float[Array, "..."]:
        values = self._numbers(self.choice.weights, place, CORRELATED_DIMENSIONS)
        if values.dtype not in (np.float32, np.float64):
            values = values.astype(np.float32)
        if self.choice.weights == WEIGHT_OF_SIGMA:
            with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
                values = np.where(values > 0, 1 / values**2, 0)
        return np.broadcast_to(values, shape)

    def _interval(self, place: dict[str, slice], counts: tuple[int, int]) -> Float[Array, "..."]:
        """Return the time that each row was averaged over [s]; that of padding means nothing.

        That is EFFECTIVE_INTEGRATION_TIME, or the nominal time in a store without it. If the channels are averages, the
        visibilities are averages over time as well: a time that is 0, negative or not finite was then not filled, and
        the nominal time is taken.
        """
        nominal = self._time_of(INTERVAL, place, counts)
        if nominal is None:
            given = self.partition.timeline.integration
            nominal = None if given is None else np.full(counts, given)
        exposure = self._time_of(EXPOSURE, place, counts)
        if exposure is None:
            return np.zeros(counts) if nominal is None else nominal
        if nominal is not None and self.partition.setup.is_averaged:
            return np.where(np.isfinite(exposure) & (exposure > 0), exposure, nominal)
        return exposure

    def _time_of(
        self, name: str, place: dict[str, slice], counts: tuple[int, int]
    ) -> Float[Array, "..."] | None:
        """Return a time [s] of each row, the longest of its samples; None if there is no such variable."""
        if name not in self.group.variables:
            return None
        values: Array = self._numbers(name, place, CORRELATED_DIMENSIONS).astype(float)
        return np.broadcast_to(_longest(values), counts)

    def _is_padding(
        self, uvw: Float[Array, "step baseline 3"], place: dict[str, slice]
    ) -> Bool[Array, "step baseline"]:
        """Tell where a baseline has no visibility at a time: writers fill missing values with NaN."""
        padding = np.isnan(uvw).all(axis=2)
        exposure = self._time_of(EXPOSURE, place, padding.shape) if padding.any() else None
        return padding if exposure is None else padding & np.isnan(exposure)


def _longest(times: Float[Array, "step baseline chan corr"]) -> Float[Array, "step baseline"]:
    """Return the longest time of each row, whose samples may have different times; NaN where there is none."""
    longest = np.where(np.isnan(times), -np.inf, times).max(axis=(2, 3))
    return np.where(np.isneginf(longest), np.nan, longest)
