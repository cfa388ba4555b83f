"""Metadata of a Measurement Set, with checks: everything but the rows."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.constants import ARCSEC, RADIO_FREQUENCIES
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre, separation
from uvshear.interferometer.dishes import SAME_POINTING
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.stokes import parallel_hands
from uvshear.io.array_size import longest_baseline
from uvshear.typing import Array, Float

NEEDED_COLUMNS = ("UVW", "FLAG", "ANTENNA1", "ANTENNA2", "DATA_DESC_ID", "FIELD_ID", "TIME")
AVERAGED_COLUMNS = ("EXPOSURE", "INTERVAL")
WEIGHT_COLUMNS = ("WEIGHT_SPECTRUM", "WEIGHT", "SIGMA")
FRAMES = ("J2000", "ICRS")
ROWS_SCANNED = 2**20
WEIGHT_PROBES = 256


@dataclass(frozen=True)
class DataDescription:
    """Layout of the rows of one DATA_DESC_ID.

    Parameters
    ----------
    identifier
        The DATA_DESC_ID.
    channels
        Channels of its spectral window.
    averaged
        Band that each channel was averaged over [Hz]: EFFECTIVE_BW (0 where nothing was averaged), or the width of
        the channel in a set without it.
    correlations
        Number of correlations.
    hands
        Indices of the correlations that make Stokes I.
    """

    identifier: int
    channels: Channels
    averaged: Float[Array, " chan"]
    correlations: int
    hands: tuple[int, ...]


@dataclass(frozen=True)
class Header:
    """Metadata of a Measurement Set that are read once.

    Parameters
    ----------
    rows
        Number of rows of the main table.
    field_id
        The one FIELD_ID that is read.
    is_only_field
        Whether all rows have this FIELD_ID.
    phase_centre
        Phase centre of this field.
    descriptions
        Layout of each DATA_DESC_ID, in order.
    weight_column
        WEIGHT_SPECTRUM, WEIGHT or SIGMA: the first that is filled.
    interval_column
        Column of the time that a row was averaged over: EXPOSURE (0 where nothing was averaged), INTERVAL in a set
        without it, or None.
    longest_baseline
        Length that no baseline of the array exceeds [m]; None where the positions of its antennas are not known.
    """

    rows: int
    field_id: int
    is_only_field: bool
    phase_centre: PhaseCentre
    descriptions: tuple[DataDescription, ...]
    weight_column: str
    interval_column: str | None
    longest_baseline: float | None = None


@contextmanager
def casacore_errors(path: Path, what: str) -> Iterator[None]:
    """Turn casacore's own errors into one line."""
    try:
        yield
    except (RuntimeError, OSError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{path}: {what} cannot be read ({reason})") from error


@contextmanager
def open_table(path: Path, subtable: str = "") -> Iterator[tables.table]:
    """Open for reading, and close."""
    with casacore_errors(path, f"the {subtable or 'main'} table"):
        opened = tables.table(str(path / subtable), ack=False)
    try:
        yield opened
    finally:
        opened.close()


def read_header(path: Path, column: str, field: int | str | None) -> Header:
    """Read the metadata and check them; an error is one line."""
    check_is_measurement_set(path)
    with open_table(path) as main:
        _check_columns(path, main, column)
        if main.nrows() == 0:
            raise InputError(f"{path}: has no rows; an observation with visibilities is needed")
        with casacore_errors(path, "a column of the main table or of a subtable"):
            field_id, is_only_field = _choose_field(path, main, field)
            return Header(
                rows=main.nrows(),
                field_id=field_id,
                is_only_field=is_only_field,
                phase_centre=read_direction(path, field_id),
                descriptions=_descriptions(path),
                weight_column=_weight_column(path, main, column),
                interval_column=_interval_column(main),
                longest_baseline=longest_baseline(path, main),
            )


def check_is_measurement_set(path: Path) -> None:
    """Refuse a path that is not a Measurement Set, and say what it is instead."""
    if not path.exists():
        raise InputError(f"{path}: no such file; the path of a Measurement Set is needed")
    if not (path / "table.dat").is_file():
        raise InputError(f"{path}: not a Measurement Set (a directory that holds table.dat)")
    with open_table(path) as main:
        if "MS_VERSION" not in main.keywordnames() or "SPECTRAL_WINDOW" not in main.keywordnames():
            raise InputError(
                f"{path}: a casacore table, but not a Measurement Set (MS_VERSION is missing);"
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


def _check_columns(path: Path, main: tables.table, column: str) -> None:
    check_column(path, main, column)
    present = main.colnames()
    missing = [name for name in NEEDED_COLUMNS if name not in present]
    if missing:
        raise InputError(
            f"{path}: has no column {', '.join(missing)}, which every Measurement Set must have; this one is damaged"
        )


def visibility_columns(main: tables.table) -> tuple[str, ...]:
    """Names of the columns of complex numbers."""
    return tuple(name for name in main.colnames() if _is_complex_column(main, name))


def _is_complex_column(main: tables.table, name: str) -> bool:
    return str(main.coldatatype(name)) in {"complex", "dcomplex"}


def fields_present(path: Path, main: tables.table) -> dict[int, str | None]:
    """Name of each FIELD_ID that has rows, in order; None where FIELD does not have it."""
    with open_table(path, "FIELD") as fields:
        names = [str(name) for name in fields.getcol("NAME")] if fields.nrows() else []
    if not names:
        raise InputError(f"{path}: FIELD is empty, so there is no phase centre; it needs a row")
    if len(names) == 1:
        present = {0}
    else:
        present = set()
        for start in range(0, main.nrows(), ROWS_SCANNED):
            present |= set(np.unique(main.getcol("FIELD_ID", start, ROWS_SCANNED)).tolist())
    return {
        number: names[number] if 0 <= number < len(names) else None for number in sorted(present)
    }


def _choose_field(path: Path, main: tables.table, field: int | str | None) -> tuple[int, bool]:
    """Return the FIELD_ID to read, and whether all rows have it."""
    present = fields_present(path, main)
    listed = ", ".join(f"{index} ({name})" for index, name in present.items() if name is not None)
    if field is None:
        if len(present) > 1:
            raise InputError(f"{path}: several fields, {listed}; choose one with --field (field=)")
        chosen = next(iter(present))
    else:
        matching = [number for number, name in present.items() if field in (number, name)]
        if not matching:
            raise InputError(f"{path}: no rows of field {field}; the fields with rows are {listed}")
        chosen = matching[0]
    if present[chosen] is None:
        raise InputError(f"{path}: FIELD_ID {chosen} has no row in FIELD, and so no phase centre")
    return chosen, len(present) == 1


def check_scans(path: Path, scans: Sequence[int]) -> None:
    """Refuse scans that have no rows."""
    present: set[int] = set()
    with open_table(path) as main, casacore_errors(path, "SCAN_NUMBER"):
        for start in range(0, main.nrows(), ROWS_SCANNED):
            present |= set(np.unique(main.getcol("SCAN_NUMBER", start, ROWS_SCANNED)).tolist())
    if absent := sorted(set(scans) - present):
        known = ", ".join(str(scan) for scan in sorted(present))
        raise InputError(f"{path}: no rows of scan {absent[0]}; the scans with rows are {known}")


def read_direction(path: Path, field: int, column: str = "PHASE_DIR") -> PhaseCentre:
    """Read a direction of a field that does not move."""
    with open_table(path, "FIELD") as fields:
        if column not in fields.colnames() or not fields.iscelldefined(column, field):
            raise InputError(f"{path}: FIELD has no {column} for field {field}; it needs one")
        reference = fields.getcolkeywords(column).get("MEASINFO", {})
        direction = np.ravel(fields.getcell(column, field))
    frame = reference.get("Ref", "J2000")
    if "VarRefCol" in reference or frame not in FRAMES:
        raise InputError(
            f"{path}: {column} of FIELD is in frame {reference.get('VarRefCol', frame)};"
            f" {' or '.join(FRAMES)} for all rows is needed"
        )
    if len(direction) > 2 and np.any(direction[2:] != 0):
        raise InputError(
            f"{path}: field {field} moves ({column} is a polynomial in time); a fixed direction is needed"
        )
    ra, dec = (float(angle) for angle in direction[:2])
    if not (math.isfinite(ra) and abs(dec) <= math.pi / 2):
        raise InputError(f"{path}: {column} of field {field} is ({ra}, {dec}); radians are needed")
    return PhaseCentre(ra=ra, dec=dec)


def read_pointing(path: Path, field: int) -> PhaseCentre:
    """Read the pointing direction of the dishes in a field.

    That is REFERENCE_DIR of FIELD, or DELAY_DIR in a set without: a change of the phase centre after the observation
    changes PHASE_DIR only. A set with neither is taken to have the phase centre of the observation.
    """
    with open_table(path, "FIELD") as fields:
        present = [
            name
            for name in ("REFERENCE_DIR", "DELAY_DIR")
            if name in fields.colnames() and fields.iscelldefined(name, field)
        ]
    axes = [read_direction(path, field, name) for name in present or ("PHASE_DIR",)]
    apart = max(separation(axes[0], axis) for axis in axes)
    if apart > SAME_POINTING:
        raise InputError(
            f"{path}: REFERENCE_DIR and DELAY_DIR of FIELD are {apart / ARCSEC:.3g} arcsec apart, so it is not known"
            " where the dishes pointed; make the two agree, or measure without a primary beam (--primary-beam none,"
            " primary_beam=None)"
        )
    return axes[0]


def read_diameters(path: Path) -> Float[Array, " antenna"]:
    """Read the diameter of each antenna's dish [m]; 0 where it is not given."""
    with open_table(path, "ANTENNA") as table, casacore_errors(path, "ANTENNA"):
        return np.asarray(table.getcol("DISH_DIAMETER"), float)


def _descriptions(path: Path) -> tuple[DataDescription, ...]:
    with open_table(path, "DATA_DESCRIPTION") as subtable:
        windows = subtable.getcol("SPECTRAL_WINDOW_ID")
        polarizations = subtable.getcol("POLARIZATION_ID")
    found = []
    with open_table(path, "SPECTRAL_WINDOW") as spectral, open_table(path, "POLARIZATION") as feeds:
        for index, (window, polarization) in enumerate(zip(windows, polarizations, strict=True)):
            types = feeds.getcell("CORR_TYPE", int(polarization))
            try:
                channels = Channels(
                    frequency=np.asarray(spectral.getcell("CHAN_FREQ", int(window)), dtype=float),
                    width=np.abs(np.asarray(spectral.getcell("CHAN_WIDTH", int(window)), float)),
                )
                hands = parallel_hands([int(code) for code in types])
            except InputError as error:
                raise InputError(f"{path}: DATA_DESC_ID {index}: {error}") from None
            averaged = _averaged(spectral, int(window), channels)
            found.append(DataDescription(index, channels, averaged, len(types), hands))
    if not found:
        raise InputError(
            f"{path}: DATA_DESCRIPTION is empty; it needs a row for each spectral window"
        )
    return tuple(found)


def _averaged(spectral: tables.table, window: int, channels: Channels) -> Float[Array, " chan"]:
    column = "EFFECTIVE_BW"
    if column not in spectral.colnames() or not spectral.iscelldefined(column, window):
        return channels.width
    averaged = np.abs(np.asarray(spectral.getcell(column, window), float))
    is_credible = averaged <= RADIO_FREQUENCIES[1]
    usable = averaged.shape == channels.width.shape and bool(is_credible.all())
    return averaged if usable else channels.width


def _weight_column(path: Path, main: tables.table, column: str) -> str:
    """Return the first weight column that is filled, judged by rows spread over the set."""
    rows = np.unique(np.linspace(0, main.nrows() - 1, WEIGHT_PROBES).astype(int)).tolist()
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


def _interval_column(main: tables.table) -> str | None:
    return next((name for name in AVERAGED_COLUMNS if name in main.colnames()), None)
