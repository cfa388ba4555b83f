"""Read Stokes I from a Measurement Set, a block of rows at a time."""

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np
from casacore import tables

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.origin import Origin
from uvshear.interferometer.sample_counts import SampleCounts
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.visibilities import Integrations, Visibilities
from uvshear.io.correlated_rows import (
    BYTES_PER_ROW,
    BYTES_PER_SAMPLE,
    CorrelatedRows,
    check_usable,
    hands_slice,
    usable_chunks,
)
from uvshear.io.measurement_set.averaged_columns import read_averages
from uvshear.io.measurement_set.averaging_time import averaging_time
from uvshear.io.measurement_set.descriptions import DataDescription
from uvshear.io.measurement_set.empty_cells import rows_without_value
from uvshear.io.measurement_set.fields import read_pointing
from uvshear.io.measurement_set.header import (
    Header,
    check_scans,
    check_subtracted,
    read_header,
)
from uvshear.io.measurement_set.opening import casacore_errors, open_table
from uvshear.io.measurement_set.uvw_sign import uvw_sign_agrees
from uvshear.io.reading import Reading
from uvshear.typing import Array, Complex, Float, Int


@dataclass(frozen=True)
class MeasurementSet:
    """One field of a Measurement Set as an observation of Stokes I.

    It holds no open table, so that it can be pickled; a worker opens the set by its path.

    Parameters
    ----------
    path
        Path of the set.
    column
        Column of visibilities: DATA, CORRECTED_DATA, ...
    field
        FIELD_ID or name; needed only where rows of several fields are present. A name that several rows of FIELD share
        stands for all of them, if they have the same phase centre.
    memory
        Size of a chunk's buffers, whatever the number of rows [bytes].
    heeds_flags
        Whether flagged visibilities are left out; False is meant for a first look at a set whose flags are wrong.
    scans
        SCAN_NUMBERs to read; all unless given.
    conjugates
        Whether UVW is taken with the opposite sign, for a set whose visibilities do not agree with the stored sign.
    subtracted
        Column of a model that is subtracted from the visibilities: MODEL_DATA.
    """

    path: str | Path
    column: str = "DATA"
    field: int | str | None = None
    memory: int = 2**25
    heeds_flags: bool = True
    scans: tuple[int, ...] | None = None
    conjugates: bool = False
    subtracted: str | None = None
    header: Header = dataclasses.field(init=False, repr=False)

    def __post_init__(self) -> None:
        header = read_header(Path(self.path), self.column, self.field)
        if self.scans is not None and header.has_averages:
            raise InputError(
                f"{self.path}: scans cannot be chosen, because the rows are averages over cells of (u, v, w); choose"
                " them when the averages are made (uvshear average --scans)"
            )
        if self.scans is not None:
            check_scans(Path(self.path), self.scans)
        if self.subtracted is not None:
            check_subtracted(Path(self.path), self.column, self.subtracted)
        object.__setattr__(self, "header", header)

    def __getstate__(self) -> dict[str, object]:
        """Give the whole path: a worker may have another working directory."""
        return {**self.__dict__, "path": Path(self.path).absolute()}

    @classmethod
    def from_reading(cls, path: str | Path, reading: Reading) -> Self:
        """Open a set as a reading says."""
        return cls(
            path,
            column=reading.column,
            field=reading.field,
            heeds_flags=reading.heeds_flags,
            scans=reading.scans,
            conjugates=reading.conjugates,
            subtracted=reading.subtracted,
        )

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0, the field's PHASE_DIR."""
        return self.header.phase_centre

    @property
    def spectral_windows(self) -> tuple[Channels, ...]:
        """Channels of each DATA_DESC_ID that the field has."""
        return tuple(description.channels for description in self.header.descriptions)

    def chunks(self) -> Iterator[Visibilities]:
        """Read the cross-correlations once; a chunk has one spectral window.

        Raises
        ------
        InputError
            At the end, when nothing read had a positive weight.
        """
        return usable_chunks(Path(self.path), self.unchecked_chunks(), self.scans)

    def unchecked_chunks(self) -> Iterator[Visibilities]:
        """Read everything once, including chunks without a cross-correlation and sets without a usable sample."""
        return self._chunks_between(0, self.rows)

    def rows_between(self, first: int, stop: int) -> Iterator[Visibilities]:
        """Read the cross-correlations of the rows from ``first``, which begins a chunk, up to ``stop``."""
        return (seen for seen in self._chunks_between(first, stop) if len(seen))

    def _chunks_between(self, first: int, stop: int) -> Iterator[Visibilities]:
        path = Path(self.path)
        with open_table(path) as main, casacore_errors(path, "the main table"):
            reader = _Reader(main, self)
            empty = rows_without_value(main, reader.columns)
            for start in range(first, stop, self.rows_per_chunk):
                count = min(self.rows_per_chunk, stop - start)
                for description, rows in reader.split(start, count):
                    empty.check(path, rows)
                    yield reader.read(description, rows)

    def check_usable(self, counts: SampleCounts) -> None:
        """Refuse a set of which no visibility can be used, given the numbers of all of its samples."""
        check_usable(Path(self.path), counts, self.scans)

    @property
    def rows(self) -> int:
        """Number of rows of the set, those of other fields included."""
        return self.header.rows

    @property
    def samples_per_row(self) -> int:
        """Largest number of channels of a row."""
        return max(len(description.channels) for description in self.header.descriptions)

    @property
    def rows_per_chunk(self) -> int:
        """Number of rows whose buffers fill ``memory``."""
        samples = max(
            len(description.channels) * description.correlations
            for description in self.header.descriptions
        )
        return max(1, self.memory // (BYTES_PER_SAMPLE * samples + BYTES_PER_ROW))

    def expected_samples(self) -> float:
        """Return the number of samples of the main table, with those of other fields and scans."""
        channels = [len(description.channels) for description in self.header.descriptions]
        return self.header.rows * sum(channels) / len(channels)

    def origin(self) -> Origin:
        """Return the set itself, under its path."""
        return Origin(self, str(self.path))

    def notices(self) -> tuple[str, ...]:
        """Return the facts in the metadata that a user of this set should know."""
        found = []
        if self.header.weight_column == "SIGMA":
            found.append("WEIGHT has no value above zero; the weights are 1/SIGMA^2")
        if len(numbers := self.header.field.numbers) > 1:
            found.append(
                f"FIELD_IDs {', '.join(map(str, numbers))} have one name, {self.header.field.name}, and one phase"
                " centre; they are read as one field"
            )
        if self.header.averaging_notice is not None:
            found.append(self.header.averaging_notice)
        if rows := self.header.beyond_interval:
            found.append(
                f"EXPOSURE is longer than INTERVAL in {rows} rows; they are taken to be averages over EXPOSURE"
            )
        if not self.header.antennas.is_readable:
            found.append(
                "the table ANTENNA cannot be read; the sign of UVW is not checked, and no dishes are known"
            )
        if (notice := self.header.extent.notice) is not None:
            found.append(notice)
        for description in self.header.descriptions:
            found += [
                f"DATA_DESC_ID {description.identifier}: {fact}" for fact in description.oddities
            ]
        return tuple(found)

    def uvw_agrees(self) -> bool | None:
        """Whether UVW, as it is read, is X(ANTENNA1) - X(ANTENNA2) by the antennas' positions; None if neither fits."""
        stored = uvw_sign_agrees(Path(self.path), self.header)
        return None if stored is None else stored is not self.conjugates

    def dish_diameters(self) -> Float[Array, " antenna"]:
        """Return DISH_DIAMETER of each antenna [m]; 0 where it is not given."""
        return self.header.antennas.diameters

    def pointing_direction(self) -> PhaseCentre:
        """Return where the dishes pointed: REFERENCE_DIR of the field, or DELAY_DIR, or PHASE_DIR in a set without."""
        return read_pointing(Path(self.path), self.header.field.numbers[0])


class _Reader:
    """One pass over an open table, with buffers that are reused from chunk to chunk."""

    def __init__(self, main: tables.table, data: MeasurementSet) -> None:
        self.main, self.column, self.header = main, data.column, data.header
        self.heeds_flags, self.scans = data.heeds_flags, data.scans
        self.sign = -1.0 if data.conjugates else 1.0
        self.subtracted, self.path = data.subtracted, Path(data.path)
        self.has_flag_row = "FLAG_ROW" in main.colnames()
        self.buffers: dict[str, Array] = {}
        self.checked: set[tuple[str, tuple[int, ...]]] = set()
        names = (self.column, self.subtracted, self.header.weight_column, "FLAG", "UVW")
        self.columns = tuple(name for name in names if name is not None)

    def split(self, start: int, count: int) -> Iterator[tuple[DataDescription, Int[Array, " row"]]]:
        """Yield the rows of the chosen field and scans, spectral window by spectral window."""
        rows = np.arange(start, start + count)
        if not self.header.is_only_field:
            fields = self.main.getcol("FIELD_ID", start, count)
            rows = rows[np.isin(fields, self.header.field.numbers)]
        if self.scans is not None:
            scans = self.main.getcol("SCAN_NUMBER", start, count)[rows - start]
            rows = rows[np.isin(scans, self.scans)]
        if len(self.header.descriptions) == 1:
            if len(rows):
                yield self.header.descriptions[0], rows
            return
        identifiers = self.main.getcol("DATA_DESC_ID", start, count)[rows - start]
        for description in self.header.descriptions:
            selected = rows[identifiers == description.identifier]
            if len(selected):
                yield description, selected

    def read(self, description: DataDescription, rows: Int[Array, " row"]) -> Visibilities:
        """Read Stokes I of some rows of one spectral window."""
        table, start = self.main, int(rows[0])
        if rows[-1] - rows[0] + 1 != len(rows):
            table, start = self.main.selectrows(rows), 0
        count = len(rows)
        shape = (count, len(description.channels), description.correlations)
        correlations = self._visibilities(table, self.column, start, shape)
        if self.subtracted is not None:
            correlations -= self._visibilities(table, self.subtracted, start, shape)
        flags = self._fill(table, "FLAG", start, shape, np.dtype(bool))
        if self.has_flag_row:
            flags |= table.getcol("FLAG_ROW", start, count)[:, None, None]
        if not self.heeds_flags:
            flags[:] = False
        weights = self._weights(table, start, shape)
        uvw = self.sign * self._fill(table, "UVW", start, (count, 3), np.dtype(float))
        integrations = self._integrations(table, description, start, count)
        hands = hands_slice(description.hands)
        found = CorrelatedRows(
            uvw, integrations, correlations[..., hands], weights[..., hands], flags[..., hands]
        )
        seen = found.combine(description.channels.frequency, description.averaged)
        if self.header.has_averages:
            with casacore_errors(self.path, "the columns of averages"):
                # The width of the window is that of the sub-band.
                frequency = float(description.channels.frequency[0])
                averages = read_averages(table, start, count, frequency)
                seen = replace(seen, width=None, averages=averages)
        return replace(seen, array=self.header.extent)

    def _visibilities(
        self, table: tables.table, column: str, start: int, shape: tuple[int, int, int]
    ) -> Complex[Array, "row chan corr"]:
        dtype = np.dtype("c16" if table.coldatatype(column) == "dcomplex" else "c8")
        return self._fill(table, column, start, shape, dtype)

    def _integrations(
        self, table: tables.table, description: DataDescription, start: int, count: int
    ) -> Integrations:
        antennas = [table.getcol(f"ANTENNA{end}", start, count) for end in (1, 2)]
        time = np.asarray(table.getcol("TIME", start, count), float)
        if not np.isfinite(time).all() and "TIME_CENTROID" in table.colnames():
            centroid = np.asarray(table.getcol("TIME_CENTROID", start, count), float)
            time = np.where(np.isfinite(time), time, centroid)
        interval = averaging_time(
            self.path, table, start, count, is_averaged=description.is_averaged
        )
        return Integrations(np.column_stack(antennas), time, interval)

    def _weights(
        self, table: tables.table, start: int, shape: tuple[int, int, int]
    ) -> Float[Array, "row chan corr"]:
        column = self.header.weight_column
        if column == "WEIGHT_SPECTRUM":
            return self._fill(table, column, start, shape, np.dtype("f4"))
        rows, _, correlations = shape
        values = self._fill(table, column, start, (rows, correlations), np.dtype("f4"))
        if column == "SIGMA":
            with np.errstate(divide="ignore", over="ignore"):
                values = np.where(values > 0, 1 / values**2, 0)
        return np.broadcast_to(values[:, None, :], shape)

    def _fill(
        self, table: tables.table, column: str, start: int, shape: tuple[int, ...], dtype: np.dtype
    ) -> Array:
        """Read a column into this column's buffer."""
        self._check_cells(table, column, start, shape[1:])
        size = int(np.prod(shape))
        if column not in self.buffers or self.buffers[column].size < size:
            self.buffers[column] = np.empty(size, dtype=dtype)
        view = self.buffers[column][:size].reshape(shape)
        with casacore_errors(self.path, f"column {column}"):
            table.getcolnp(column, view, start, shape[0])
        return view

    def _check_cells(
        self, table: tables.table, column: str, start: int, expected: tuple[int, ...]
    ) -> None:
        """Refuse a column of another shape than its description says, judged by the first cell that is read."""
        if (column, expected) in self.checked:
            return
        with casacore_errors(self.path, f"column {column}"):
            shape = np.shape(table.getcell(column, start))
        if shape != expected:
            raise InputError(
                f"{self.path}: column {column} has a cell of shape {shape}; {expected} is needed by the numbers of"
                " channels and correlations in SPECTRAL_WINDOW and POLARIZATION"
                if column != "UVW"
                else f"{self.path}: column UVW has a cell of shape {shape}; three coordinates are needed"
            )
        self.checked.add((column, expected))
