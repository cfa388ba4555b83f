"""Metadata of Measurement Sets, and what is refused in them."""

import shutil

import pytest
from casacore import tables

from tests.io.measurement_sets import change, edited, written
from uvshear.errors import InputError
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.observations import inspect


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _remove_column(path, column, subtable=""):
    with edited(path, subtable) as table:
        table.removecols(column)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.ms: no such file"):
        MeasurementSet(tmp_path / "nothing.ms")


def test_a_file_that_is_no_measurement_set_is_named(tmp_path):
    text = tmp_path / "a.txt"
    text.write_text("x")
    for wrong in (text, tmp_path):
        with pytest.raises(InputError, match="not a Measurement Set"):
            MeasurementSet(wrong)


def test_a_subtable_is_no_measurement_set(path):
    with pytest.raises(InputError, match="give the Measurement Set itself, not one of its subt"):
        MeasurementSet(path / "ANTENNA")


def test_a_damaged_table_is_one_line(path):
    (path / "table.dat").write_bytes(b"nonsense")
    with pytest.raises(InputError, match=r"field\.ms: the main table cannot be read") as caught:
        MeasurementSet(path)
    assert "\n" not in str(caught.value)


def test_a_missing_column_lists_those_with_visibilities(path):
    with pytest.raises(
        InputError, match=r"no column CORRECTED_DATA; the columns that hold visibilities are DATA$"
    ):
        MeasurementSet(path, column="CORRECTED_DATA")
    with pytest.raises(InputError, match="column UVW holds double, not complex"):
        MeasurementSet(path, column="UVW")


def test_a_missing_uvw_is_named(path):
    _remove_column(path, "UVW")
    with pytest.raises(InputError, match="no column UVW"):
        MeasurementSet(path)


def test_no_rows_is_an_error(path, tmp_path):
    empty = tmp_path / "empty.ms"
    with tables.table(str(path), ack=False) as main:
        main.copy(str(empty), deep=True, copynorows=True).close()
    for function in (MeasurementSet, inspect):
        with pytest.raises(InputError, match="has no rows"):
            function(empty)


def test_a_missing_subtable_is_an_error(path):
    shutil.rmtree(path / "FIELD")
    with pytest.raises(InputError, match="the FIELD table cannot be read"):
        MeasurementSet(path)


def test_a_frequency_of_zero_is_an_error(path):
    change(path, "CHAN_FREQ", 0.0, subtable="SPECTRAL_WINDOW")
    with pytest.raises(InputError, match="DATA_DESC_ID 0: a channel's frequency is not positive"):
        MeasurementSet(path)


def test_crossed_hands_alone_are_an_error(path):
    change(path, "CORR_TYPE", [[10, 11]], subtable="POLARIZATION")
    with pytest.raises(InputError, match=r"\[10, 11\] do not give Stokes I"):
        MeasurementSet(path)
