"""Metadata of a Measurement Set, with checks: everything but the rows."""

from collections.abc import Sequence
from dataclasses import dataclass
from dataclasses import field as default
from pathlib import Path
from typing import Final

import numpy as np
from casacore import tables

from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.array_extent import ArrayExtent
from uvshear.io.measurement_set.antennas import KnownAntennas, read_antennas
from uvshear.io.measurement_set.array_size import array_size
from uvshear.io.measurement_set.averaged_columns import has_averages
from uvshear.io.measurement_set.averaging_time import averaging_notice, rows_beyond_interval
from uvshear.io.measurement_set.column_types import check_types
from uvshear.io.measurement_set.descriptions import DataDescription, read_descriptions
from uvshear.io.measurement_set.fields import NamedField, choose_field, fields_with_rows
from uvshear.io.measurement_set.opening import casacore_errors, open_table

NEEDED_COLUMNS = ("UVW", "FLAG", "ANTENNA1", "ANTENNA2", "DATA_DESC_ID", "FIELD_ID", "TIME")
WEIGHT_COLUMNS = ("WEIGHT_SPECTRUM", "WEIGHT", "SIGMA")
ROWS_SCANNED = 2**20
PROBES = 256
"""Number of rows, spread over the set, by which a column is judged."""


@dataclass(frozen=True)
class Header:
    """Metadata of a Measurement Set that are read once.

    Parameters
    ----------
    rows
        Number of rows of the main table.
    field
        The field that is read.
    is_only_field
        Whether all rows are of this field.
    descriptions
        Layout of each DATA_DESC_ID that has rows of this field, in order.
    weight_column
        WEIGHT_SPECTRUM, WEIGHT or SIGMA: the first that is filled.
    averaging_notice
        What is missing in the averaging times of the rows; None if nothing is.
    beyond_interval
        Number of rows whose EXPOSURE is longer than INTERVAL.
    antennas
        Antennas of the set.
    extent
        The extent of the array by the positions of its antennas.
    has_averages
        Whether the rows are averages over cells of (u, v, w), which have no antennas and no scans.
    """

    rows: int
    field: NamedField
    is_only_field: bool
    descriptions: tuple[DataDescription, ...]
    weight_column: str
    averaging_notice: str | None
    beyond_interval: int = 0
    antennas: KnownAntennas = default(default_factory=KnownAntennas)
    extent: ArrayExtent = default(default_factory=ArrayExtent)
    has_averages: bool = False

    @property
    def phase_centre(self) -> PhaseCentre:
        """Direction of l = m = 0."""
        return self.field.phase_centre


@dataclass(frozen=True)
class Content:
    """Numbers by which the rows of the main table refer to subtables.

    Parameters
    ----------
    descriptions
        For each FIELD_ID that has rows, the DATA_DESC_IDs of these rows.
    """

    descriptions: dict[int, tuple[int, ...]]

    @property
    def fields(self) -> tuple[int, ...]:
        """FIELD_IDs that have rows, in order."""
        return tuple(sorted(self.descriptions))

    def of_fields(self, numbers: Sequence[int]) -> tuple[int, ...]:
        """DATA_DESC_IDs of some fields, in order."""
        return tuple(sorted({one for number in numbers for one in self.descriptions[number]}))


def read_header(path: Path, column: str, field: int | str | None) -> Header:
    """Read the metadata and check them; an error is one line."""
    check_is_measurement_set(path)
    with open_table(path) as main:
        _check_rows(path, main)
        _check_columns(path, main, column)
        with casacore_errors(path, "a column of the main table or of a subtable"):
            content = read_content(main)
            antennas = read_antennas(path)
            chosen = choose_field(path, content.fields, field)
            descriptions = read_descriptions(path, content.of_fields(chosen.numbers))
            return Header(
                rows=main.nrows(),
                field=chosen,
                is_only_field=len(chosen.numbers) == len(content.fields),
                descriptions=descriptions,
                weight_column=_weight_column(path, main, column),
                averaging_notice=averaging_notice(
                    main,
                    _probed_rows(main),
                    is_averaged=not has_averages(main)
                    and any(description.is_averaged for description in descriptions),
                ),
                beyond_interval=rows_beyond_interval(main),
                antennas=antennas,
                extent=array_size(main, antennas),
                has_averages=has_averages(main),
            )


def read_content(main: tables.table) -> Content:
    """Read the FIELD_ID and the DATA_DESC_ID of every row."""
    found: set[tuple[int, int]] = set()
    for start in range(0, main.nrows(), ROWS_SCANNED):
        field, one = (
            main.getcol(name, start, ROWS_SCANNED) for name in ("FIELD_ID", "DATA_DESC_ID")
        )
        # A sort of pairs would take half a second for a million rows; most rows have the pair of the row before.
        is_new = np.ones(len(field), bool)
        is_new[1:] = (field[1:] != field[:-1]) | (one[1:] != one[:-1])
        found |= set(zip(field[is_new].tolist(), one[is_new].tolist(), strict=True))
    fields = sorted({field for field, _ in found})
    return Content(
        {field: tuple(sorted(one for of, one in found if of == field)) for field in fields}
    )


def read_fields(path: Path) -> tuple[NamedField, ...]:
    """Return the fields that have rows."""
    check_is_measurement_set(path)
    with open_table(path) as main, casacore_errors(path, "FIELD_ID"):
        _check_rows(path, main)
        check_types(path, main)
        return fields_with_rows(path, read_content(main).fields)


_KEYWORDS: Final = ("MS_VERSION", "SPECTRAL_WINDOW")
"""Keywords by which a Measurement Set is distinguished from other tables."""


def check_is_measurement_set(path: Path) -> None:
    """Refuse a path that is not a Measurement Set, and say what it is instead."""
    if not path.exists():
        raise InputError(f"{path}: no such file; the path of a Measurement Set is needed")
    if not (path / "table.dat").is_file():
        raise InputError(f"{path}: not a Measurement Set (a directory that holds table.dat)")
    with open_table(path) as main:
        if lacking := [name for name in _KEYWORDS if name not in main.keywordnames()]:
            raise InputError(
                f"{path}: a casacore table, but not a Measurement Set (its keyword {lacking[0]} is missing);"
                " give the Measurement Set itself, not one of its subtables"
            )


def check_column(path: Path, main: tables.table, column: str) -> None:
    """Refuse a column without visibilities."""
    if column not in main.colnames():
        like = visibility_columns(main)
        raise InputError(
            f"{path}: no column {column}; the columns that hold visibilities are {', '.join(like) or 'none'}"
        )
    if not _is_complex_column(main, column):
        raise InputError(
            f"{path}: column {column} holds {main.coldatatype(column)}, not complex visibilities"
        )


def check_subtracted(path: Path, column: str, subtracted: str) -> None:
    """Refuse a model that cannot be subtracted from a column."""
    if subtracted == column:
        raise InputError(
            f"{path}: column {column} would be subtracted from itself; --subtract (subtracted=) names the column of"
            " a model"
        )
    with open_table(path) as main:
        check_column(path, main, subtracted)
        with casacore_errors(path, f"column {subtracted}"):
            shapes = [main.getcell(name, 0).shape for name in (column, subtracted)]
    if shapes[0] != shapes[1]:
        raise InputError(
            f"{path}: column {subtracted} has {shapes[1]} channels and correlations in its first row, and"
            f" {column} {shapes[0]}; they must be the same"
        )


def _check_rows(path: Path, main: tables.table) -> None:
    if main.nrows() == 0:
        raise InputError(f"{path}: has no rows; an observation with visibilities is needed")


def _check_columns(path: Path, main: tables.table, column: str) -> None:
    check_column(path, main, column)
    present = main.colnames()
    missing = [name for name in NEEDED_COLUMNS if name not in present]
    if missing:
        raise InputError(
            f"{path}: has no column {', '.join(missing)}, which every Measurement Set must have; this one is damaged"
        )
    check_types(path, main)


def visibility_columns(main: tables.table) -> tuple[str, ...]:
    """Names of the columns of complex numbers."""
    return tuple(name for name in main.colnames() if _is_complex_column(main, name))


def _is_complex_column(main: tables.table, name: str) -> bool:
    return str(main.coldatatype(name)) in {"complex", "dcomplex"}


def check_scans(path: Path, scans: Sequence[int]) -> None:
    """Refuse scans that have no rows."""
    present: set[int] = set()
    with open_table(path) as main, casacore_errors(path, "SCAN_NUMBER"):
        for start in range(0, main.nrows(), ROWS_SCANNED):
            present |= set(np.unique(main.getcol("SCAN_NUMBER", start, ROWS_SCANNED)).tolist())
    if absent := sorted(set(scans) - present):
        known = ", ".join(str(scan) for scan in sorted(present))
        raise InputError(f"{path}: no rows of scan {absent[0]}; the scans with rows are {known}")


def _weight_column(path: Path, main: tables.table, column: str) -> str:
    """Return the first weight column that is filled, judged by rows spread over the set that have visibilities."""
    rows = [row for row in _probed_rows(main) if main.iscelldefined(column, row)]
    if not rows:
        raise InputError(f"{path}: column {column} has no values; visibilities are needed")
    for name in WEIGHT_COLUMNS:
        if name not in main.colnames() or not all(main.iscelldefined(name, row) for row in rows):
            continue
        if name == "WEIGHT_SPECTRUM" and any(
            np.shape(main.getcell(name, row)) != np.shape(main.getcell(column, row)) for row in rows
        ):
            continue
        if any(np.any(np.asarray(main.getcell(name, row)) > 0) for row in rows):
            return name
    raise InputError(
        f"{path}: no positive weights in {', '.join(WEIGHT_COLUMNS)};"
        " one of them must hold 1/sigma^2 (or sigma)"
    )


def _probed_rows(main: tables.table) -> list[int]:
    return np.unique(np.linspace(0, main.nrows() - 1, PROBES).astype(int)).tolist()
