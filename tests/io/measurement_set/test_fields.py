"""Fields of a Measurement Set: chosen by number or name, their directions, and what is refused."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, edited, emptied, written
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.io.measurement_set.fields import read_direction, read_pointing
from uvshear.io.measurement_set.header import read_fields, read_header
from uvshear.io.measurement_set.inspection import inspect_measurement_set
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.reading import Reading

CODES = {"TabRefTypes": ["J2000", "B1950", "ICRS"], "TabRefCodes": np.array([0, 4, 21], np.uint32)}


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _remove_column(path, column, subtable=""):
    with edited(path, subtable) as table:
        table.removecols(column)


def _add_fields(path, *names, north=0.0):
    """Add rows to FIELD, copies of the first under other names and farther North, and share the rows out in turn."""
    with edited(path, "FIELD") as fields:
        for name in names:
            row = fields.nrows()
            fields.addrows(1)
            for column in fields.colnames():
                if fields.iscelldefined(column, 0):
                    fields.putcell(column, row, fields.getcell(column, 0))
            fields.putcell("NAME", row, name)
            direction = fields.getcell("PHASE_DIR", row)
            direction[0, 1] += north
            fields.putcell("PHASE_DIR", row, direction)
        count = fields.nrows()
    with edited(path) as main:
        main.putcol("FIELD_ID", np.arange(main.nrows()) % count)


def _rows(path, field):
    return sum(len(seen) for seen in MeasurementSet(path, field=field).chunks())


def test_a_missing_phase_centre_is_an_error(path):
    _remove_column(path, "PHASE_DIR", "FIELD")
    with pytest.raises(InputError, match="FIELD has no PHASE_DIR for field 0"):
        MeasurementSet(path)


def test_an_empty_field_table_is_an_error(path):
    emptied(path, "FIELD")
    with pytest.raises(InputError, match="FIELD is empty, so there is no phase centre"):
        MeasurementSet(path)


@pytest.mark.parametrize("value", [np.nan, 57.0])
def test_a_phase_centre_that_is_none_is_an_error(path, value):
    change(path, "PHASE_DIR", value, subtable="FIELD")
    with pytest.raises(InputError, match="radians are needed"):
        MeasurementSet(path)


def test_a_phase_centre_in_another_frame_is_an_error(path):
    with edited(path, "FIELD") as field:
        field.putcolkeyword("PHASE_DIR", "MEASINFO", {"type": "direction", "Ref": "B1950"})
    with pytest.raises(InputError, match="frame B1950; J2000 or ICRS"):
        MeasurementSet(path)


def test_rows_of_one_name_and_phase_centre_are_one_field(path):
    whole = _rows(path, None)
    _add_fields(path, "simulated")
    for field in (None, "simulated", " simulated "):
        assert _rows(path, field) == whole
    assert _rows(path, 0) == _rows(path, 1) == whole // 2
    (told,) = MeasurementSet(path, field="simulated").notices()
    assert "FIELD_IDs 0, 1 have one name, simulated, and one phase centre" in told
    (shown,) = inspect_measurement_set(path, Reading()).fields
    assert shown.counts.rows == whole


def test_a_name_of_several_phase_centres_is_refused(path):
    _add_fields(path, "simulated", north=ARCSEC)
    with pytest.raises(
        InputError, match=r"field simulated is the name of several .* FIELD_IDs 0, 1; choose"
    ):
        MeasurementSet(path, field="simulated")
    with pytest.raises(
        InputError, match=r"several fields, 0 \(simulated\), 1 \(simulated\); choose one"
    ):
        MeasurementSet(path)
    assert len(inspect_measurement_set(path, Reading()).fields) == 2


def test_a_name_may_be_a_number_or_end_in_blanks(path):
    _add_fields(path, "3 ", "0", north=0.01)
    assert read_header(path, "DATA", "3").field.numbers == (1,)
    # a name comes before a number, and an integer is always a number
    assert read_header(path, "DATA", "0").field.numbers == (2,)
    assert read_header(path, "DATA", 0).field.numbers == (0,)
    assert read_header(path, "DATA", "1").field.numbers == (1,)
    with pytest.raises(
        InputError, match=r"no rows of field 7; the fields with rows are 0 \(simulated\), 1 \(3\)"
    ):
        MeasurementSet(path, field="7")


@pytest.mark.parametrize("missing", [3, -1])
def test_a_number_without_a_row_in_field_is_refused(path, missing):
    change(path, "FIELD_ID", missing)
    for field in (None, missing):
        with pytest.raises(InputError, match=f"FIELD_ID {missing} has no row in FIELD"):
            MeasurementSet(path, field=field)
    with pytest.raises(InputError, match=f"FIELD_ID {missing} has no row in FIELD"):
        inspect_measurement_set(path, Reading())


def test_other_rows_of_field_may_say_what_they_like(path):
    expected = read_header(path, "DATA", None).phase_centre
    _add_fields(path, "moving")
    change(path, "FIELD_ID", 0)
    change(path, "PHASE_DIR", np.nan, rows=[1], subtable="FIELD")
    (field,) = read_fields(path)
    assert (field.numbers, field.phase_centre) == ((0,), expected)


def _refer_by_row(path, value, kind):
    """Let each row of FIELD name the frame of its direction."""
    example = "" if kind == "string" else 0
    with edited(path, "FIELD") as fields:
        column = tables.makescacoldesc("PhaseDir_Ref", example, valuetype=kind)
        fields.addcols(tables.maketabdesc([column]))
        fields.putcell("PhaseDir_Ref", 0, value)
        codes = CODES if kind == "int" else {}
        reference = {"type": "direction", "VarRefCol": "PhaseDir_Ref", **codes}
        fields.putcolkeyword("PHASE_DIR", "MEASINFO", reference)


@pytest.mark.parametrize(("value", "kind"), [(21, "int"), (0, "int"), ("ICRS", "string")])
def test_the_frame_of_a_direction_may_be_given_by_row(path, value, kind):
    expected = read_direction(path, 0)
    _refer_by_row(path, value, kind)
    assert MeasurementSet(path).phase_centre == expected


@pytest.mark.parametrize(
    ("value", "kind", "told"),
    [(4, "int", "B1950"), (9, "int", "number 9"), ("GALACTIC", "string", "GALACTIC")],
)
def test_a_frame_by_row_that_is_another_is_refused(path, value, kind, told):
    _refer_by_row(path, value, kind)
    with pytest.raises(InputError, match=f"frame {told}; J2000 or ICRS is needed"):
        MeasurementSet(path)


def test_a_field_that_follows_an_ephemeris_is_refused(path):
    with edited(path, "FIELD") as fields:
        fields.addcols(tables.maketabdesc([tables.makescacoldesc("EPHEMERIS_ID", 0)]))
        fields.putcell("EPHEMERIS_ID", 0, -1)
    MeasurementSet(path)
    change(path, "EPHEMERIS_ID", 2, subtable="FIELD")
    with pytest.raises(InputError, match=r"field 0 moves \(it follows EPHEMERIS_ID 2"):
        MeasurementSet(path)


def test_a_direction_of_one_number_is_refused(path):
    with edited(path, "FIELD") as fields:
        fields.putcell("PHASE_DIR", 0, np.array([[1.0]]))
    with pytest.raises(InputError, match="PHASE_DIR of field 0 has 1 numbers; right ascension and"):
        MeasurementSet(path)


def test_fields_need_no_names(path):
    _remove_column(path, "NAME", "FIELD")
    assert MeasurementSet(path).header.field.name == ""


def _point(path, column, offset):
    """Move a direction of the field to the North."""
    with edited(path, "FIELD") as fields:
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
    with edited(path, "FIELD") as fields:
        fields.removecols(["REFERENCE_DIR", "DELAY_DIR"])
    assert read_pointing(path, 0) == read_header(path, "DATA", None).phase_centre


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        ("J2000", "the keyword MEASINFO of PHASE_DIR in FIELD is 'J2000'; a record"),
        ({"VarRefCol": "GONE"}, "is said to be in the column GONE, which is not there"),
        ({"VarRefCol": "PHASE_DIR"}, "PHASE_DIR of field 0 is in frame not known"),
        ({"VarRefCol": "NUM_POLY", "TabRefCodes": "x", "TabRefTypes": 7}, "is in frame number 0"),
        ({"Ref": 7}, "is in frame 7"),
    ],
)
def test_a_frame_that_is_none_is_refused(tmp_path, frame, message):
    path = written(tmp_path)
    with edited(path, "FIELD") as fields:
        fields.removecolkeyword("PHASE_DIR", "MEASINFO")
        fields.putcolkeyword("PHASE_DIR", "MEASINFO", frame)
    with pytest.raises(InputError, match=message):
        MeasurementSet(path)


def test_an_ephemeris_that_is_no_number_is_refused(tmp_path):
    path = written(tmp_path)
    with edited(path, "FIELD") as fields:
        column = tables.makescacoldesc("EPHEMERIS_ID", "", valuetype="string")
        fields.addcols(tables.maketabdesc(column))
        fields.putcell("EPHEMERIS_ID", 0, "Mars")
    with pytest.raises(InputError, match="EPHEMERIS_ID of field 0 is 'Mars'; a whole number"):
        MeasurementSet(path)
