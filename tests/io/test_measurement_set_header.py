"""Metadata of Measurement Sets, and what is refused in them."""

import shutil

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, written
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.io.measurement_set import MeasurementSet
from uvshear.io.measurement_set_header import read_diameters, read_header, read_pointing


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _edit(path, subtable=""):
    return tables.table(str(path / subtable), readonly=False, ack=False)


def _remove_column(path, column, subtable=""):
    with _edit(path, subtable) as table:
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
    with pytest.raises(InputError, match="has no rows"):
        MeasurementSet(empty)


def test_a_missing_phase_centre_is_an_error(path):
    _remove_column(path, "PHASE_DIR", "FIELD")
    with pytest.raises(InputError, match="FIELD has no PHASE_DIR for field 0"):
        MeasurementSet(path)


def test_an_empty_field_table_is_an_error(path):
    with _edit(path, "FIELD") as field:
        field.removerows([0])
    with pytest.raises(InputError, match="FIELD is empty, so there is no phase centre"):
        MeasurementSet(path)


def test_a_missing_subtable_is_an_error(path):
    shutil.rmtree(path / "FIELD")
    with pytest.raises(InputError, match="the FIELD table cannot be read"):
        MeasurementSet(path)


@pytest.mark.parametrize("value", [np.nan, 57.0])
def test_a_phase_centre_that_is_none_is_an_error(path, value):
    change(path, "PHASE_DIR", value, subtable="FIELD")
    with pytest.raises(InputError, match="radians are needed"):
        MeasurementSet(path)


def test_a_phase_centre_in_another_frame_is_an_error(path):
    with _edit(path, "FIELD") as field:
        field.putcolkeyword("PHASE_DIR", "MEASINFO", {"type": "direction", "Ref": "B1950"})
    with pytest.raises(InputError, match="frame B1950; J2000 or ICRS"):
        MeasurementSet(path)


def test_a_frequency_of_zero_is_an_error(path):
    change(path, "CHAN_FREQ", 0.0, subtable="SPECTRAL_WINDOW")
    with pytest.raises(InputError, match="DATA_DESC_ID 0: a channel's frequency is not positive"):
        MeasurementSet(path)


def test_crossed_hands_alone_are_an_error(path):
    change(path, "CORR_TYPE", [[10, 11]], subtable="POLARIZATION")
    with pytest.raises(InputError, match=r"\[10, 11\] do not give Stokes I"):
        MeasurementSet(path)


def _point(path, column, offset):
    """Move a direction of the field to the North."""
    with _edit(path, "FIELD") as fields:
        direction = fields.getcell(column, 0)
        direction[0, 1] += offset
        fields.putcell(column, 0, direction)


def test_a_changed_phase_centre_leaves_the_pointing(path):
    before = read_pointing(path, 0)
    _point(path, "PHASE_DIR", 0.01)
    assert read_header(path, "DATA", None).phase_centre.dec == pytest.approx(before.dec + 0.01)
    assert read_pointing(path, 0) == before


def test_directions_that_disagree_leave_the_pointing_unknown(path):
    _point(path, "DELAY_DIR", 5 * ARCSEC)
    with pytest.raises(InputError, match=r"are 5 arcsec apart.*not known where the dishes pointed"):
        read_pointing(path, 0)


def test_a_set_without_other_directions_pointed_at_its_phase_centre(path):
    with _edit(path, "FIELD") as fields:
        fields.removecols(["REFERENCE_DIR", "DELAY_DIR"])
    assert read_pointing(path, 0) == read_header(path, "DATA", None).phase_centre


def test_diameters_are_those_of_the_antennas(path):
    change(path, "DISH_DIAMETER", 25.0, rows=[1], subtable="ANTENNA")
    assert read_diameters(path)[1] == 25.0
