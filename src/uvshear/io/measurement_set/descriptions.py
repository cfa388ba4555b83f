"""Data descriptions of a Measurement Set: the channels and correlations of its rows."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from casacore import tables

from uvshear.constants import RADIO_FREQUENCIES
from uvshear.errors import InputError
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.stokes import CORRELATION_NAMES, STOKES_I, parallel_hands
from uvshear.io.measurement_set.opening import casacore_errors, open_table
from uvshear.io.spectral_oddities import spectral_oddities
from uvshear.typing import Array, Float


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
    types
        CORR_TYPE of each correlation.
    hands
        Indices of the correlations that make Stokes I.
    """

    identifier: int
    channels: Channels
    averaged: Float[Array, " chan"]
    types: tuple[int, ...]
    hands: tuple[int, ...]

    @property
    def correlations(self) -> int:
        """Number of correlations."""
        return len(self.types)

    @property
    def only_hand(self) -> str | None:
        """Name of the correlation that alone is taken as Stokes I; None where two are, or where it is Stokes I."""
        if len(self.hands) > 1 or self.types[self.hands[0]] == STOKES_I:
            return None
        return CORRELATION_NAMES[self.types[self.hands[0]]]

    @property
    def oddities(self) -> tuple[str, ...]:
        """Facts that a user should know."""
        return spectral_oddities(self.channels, self.averaged, self.only_hand)

    @property
    def is_averaged(self) -> bool:
        """Whether the channels are averages over a band."""
        return bool(np.any(self.averaged > 0))


def read_descriptions(path: Path, present: Sequence[int]) -> tuple[DataDescription, ...]:
    """Read the descriptions of those DATA_DESC_IDs that have rows; the others are not checked."""
    with (
        open_table(path, "DATA_DESCRIPTION") as subtable,
        casacore_errors(path, "DATA_DESCRIPTION"),
    ):
        rows = subtable.nrows()
        windows = _rows_of(path, subtable, "SPECTRAL_WINDOW_ID") if rows else []
        polarizations = _rows_of(path, subtable, "POLARIZATION_ID") if rows else []
    if not rows:
        raise InputError(
            f"{path}: DATA_DESCRIPTION is empty; it needs a row for each spectral window (if files called table.lock"
            " were removed from the set, put them back: they may hold the numbers of rows)"
        )
    for identifier in present:
        if not 0 <= identifier < rows:
            raise InputError(
                f"{path}: DATA_DESC_ID {identifier} of the main table has no row in DATA_DESCRIPTION, which has"
                f" {rows}; the channels of its visibilities are not known"
            )
    with (
        open_table(path, "SPECTRAL_WINDOW") as spectral,
        open_table(path, "POLARIZATION") as feeds,
    ):
        return tuple(
            _read(
                path,
                identifier,
                spectral,
                windows[identifier],
                feeds,
                polarizations[identifier],
            )
            for identifier in present
        )


def _rows_of(path: Path, table: tables.table, column: str) -> list[int]:
    """Return the row of another table to which each row refers."""
    rows = np.asarray(table.getcol(column))
    if rows.ndim != 1 or rows.dtype.kind not in "iu":
        raise InputError(
            f"{path}: DATA_DESCRIPTION has a {column} that is no column of whole numbers; it is needed"
        )
    numbers: list[int] = rows.tolist()
    return numbers


def _read(
    path: Path,
    identifier: int,
    spectral: tables.table,
    window: int,
    feeds: tables.table,
    polarization: int,
) -> DataDescription:
    name = f"{path}: DATA_DESC_ID {identifier}"
    for column, number, rows in (
        ("SPECTRAL_WINDOW", window, spectral.nrows()),
        ("POLARIZATION", polarization, feeds.nrows()),
    ):
        if not 0 <= number < rows:
            raise InputError(f"{name}: its {column}_ID is {number}, but {column} has {rows} rows")
    frequency = _numbers(name, spectral, "CHAN_FREQ", window)
    width = np.abs(_numbers(name, spectral, "CHAN_WIDTH", window))
    if frequency.ndim != 1 or width.shape != frequency.shape:
        raise InputError(
            f"{name}: CHAN_FREQ has shape {frequency.shape} and CHAN_WIDTH {width.shape}; both need one number for"
            " each channel"
        )
    types = _numbers(name, feeds, "CORR_TYPE", polarization)
    if types.ndim != 1 or np.any(types % 1 != 0):
        raise InputError(
            f"{name}: CORR_TYPE is {types.tolist()}; a list of whole numbers is needed"
        )
    try:
        channels = Channels(frequency=frequency, width=width)
        hands = parallel_hands([int(code) for code in types])
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    averaged = _averaged(spectral, window, channels)
    return DataDescription(identifier, channels, averaged, tuple(map(int, types)), hands)


def _numbers(name: str, table: tables.table, column: str, row: int) -> Float[Array, "..."]:
    """Return a cell of numbers; refuse one that is not filled or holds something else."""
    if column not in table.colnames() or not table.iscelldefined(column, row):
        raise InputError(f"{name}: {column} is not filled; it is needed")
    values = np.asarray(table.getcell(column, row))
    if values.dtype.kind not in "fiu":
        raise InputError(f"{name}: {column} does not hold numbers")
    return values.astype(float)


def _averaged(spectral: tables.table, window: int, channels: Channels) -> Float[Array, " chan"]:
    column = "EFFECTIVE_BW"
    if column not in spectral.colnames() or not spectral.iscelldefined(column, window):
        return channels.width
    values = np.asarray(spectral.getcell(column, window))
    if values.dtype.kind not in "fiu" or values.shape != channels.width.shape:
        return channels.width
    averaged = np.abs(values.astype(float))
    return averaged if bool((averaged <= RADIO_FREQUENCIES[1]).all()) else channels.width
