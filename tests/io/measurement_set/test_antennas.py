"""Antennas of a Measurement Set, so far as they are known."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, emptied, written
from uvshear.io.measurement_set.antennas import read_antennas
from uvshear.io.measurement_set.inspection import inspect_measurement_set
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.reading import Reading


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _read(path):
    """Number of rows that are measured, and of antennas that are shown."""
    shown = inspect_measurement_set(path, Reading())
    return sum(len(seen) for seen in MeasurementSet(path).chunks()), shown.telescope.antennas


def test_positions_and_diameters_are_read(path):
    change(path, "DISH_DIAMETER", 25.0, rows=[1], subtable="ANTENNA")
    found = read_antennas(path)
    assert found.positions.shape == (8, 3)
    assert found.diameters[1] == 25.0
    assert found.is_readable


def _without_rows(path):
    emptied(path, "ANTENNA")


def _damaged(path):
    (path / "ANTENNA" / "table.f0").write_bytes(b"nonsense")


def _without(column):
    def spoil(path):
        with tables.table(str(path / "ANTENNA"), readonly=False, ack=False) as table:
            table.removecols(column)

    return spoil


def _beyond(path):
    for column in ("ANTENNA1", "ANTENNA2"):
        with tables.table(str(path), readonly=False, ack=False) as table:
            table.putcol(column, table.getcol(column) + 10)


@pytest.mark.parametrize(
    ("spoil", "antennas"),
    [
        (_without_rows, 0),
        (_damaged, 0),
        (_without("POSITION"), 8),
        (_without("DISH_DIAMETER"), 8),
        (_beyond, 8),
    ],
)
def test_visibilities_are_read_without_what_is_not_known_of_antennas(path, spoil, antennas):
    rows, _ = _read(path)
    spoil(path)
    assert _read(path) == (rows, antennas)


def test_a_position_that_is_none_is_not_known(path):
    change(path, "POSITION", np.nan, rows=[2], subtable="ANTENNA")
    positions = read_antennas(path).positions
    assert np.flatnonzero(np.isnan(positions).any(axis=1)).tolist() == [2]


@pytest.mark.parametrize(("spoil", "is_told"), [(_damaged, True), (_without_rows, False)])
def test_a_table_that_cannot_be_read_is_told(path, spoil, is_told):
    spoil(path)
    notices = MeasurementSet(path).notices()
    assert [
        notice.startswith("the table ANTENNA cannot be read; the sign") for notice in notices
    ] == ([True] * is_told)
    assert MeasurementSet(path).dish_diameters().shape == (0,)
