"""Rows of a Measurement Set that were never written."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, edited, written
from uvshear.errors import InputError
from uvshear.io.measurement_set.empty_cells import rows_without_value
from uvshear.io.measurement_set.observation import MeasurementSet


@pytest.fixture
def path(tmp_path):
    """A set with three rows at the end that have no visibilities; their other columns are those of the first row."""
    path = written(tmp_path)
    with edited(path) as main:
        rows = main.nrows()
        main.addrows(3)
        for name in ("UVW", "FLAG", "WEIGHT_SPECTRUM", "ANTENNA2", "TIME"):
            for row in range(rows, rows + 3):
                main.putcell(name, row, main.getcell(name, 0))
    return path


def test_they_are_found(path):
    with tables.table(str(path), ack=False) as main:
        rows = main.nrows()
        found = rows_without_value(main, ("DATA", "FLAG", "UVW", "WEIGHT_SPECTRUM"))
    assert list(found.rows) == ["DATA"]
    np.testing.assert_array_equal(found.rows["DATA"], [rows - 3, rows - 2, rows - 1])


def test_they_are_found_in_a_column_whose_unit_nobody_knows(path):
    """pyuvdata writes "uncalib"."""
    with edited(path) as main:
        main.putcolkeyword("DATA", "QuantumUnits", ["uncalib"])
        with pytest.raises(RuntimeError, match="uncalib"):
            main.query("!isdefined(DATA)")
        found = rows_without_value(main, ("DATA", "FLAG"))
    assert found.rows["DATA"].tolist() == [1680, 1681, 1682]
    assert list(found.rows) == ["DATA"]


def test_a_set_that_was_written_completely_has_none(tmp_path):
    with tables.table(str(written(tmp_path)), ack=False) as main:
        assert rows_without_value(main, ("TIME", "DATA", "FLAG")).rows == {}


def test_a_set_with_such_rows_is_refused_with_their_number(path):
    message = r"field\.ms: column DATA has no value in 3 rows, the first of which is row 1680; the"
    with pytest.raises(InputError, match=message):
        list(MeasurementSet(path).chunks())


def test_such_rows_of_another_field_do_not_matter(path):
    with edited(path, "FIELD") as fields:
        fields.addrows(1)
        fields.putcell("NAME", 1, "other")
        fields.putcell("PHASE_DIR", 1, fields.getcell("PHASE_DIR", 0) + 0.1)
    change(path, "FIELD_ID", 1, rows=slice(1680, 1683))
    chunks = list(MeasurementSet(path, field="simulated").chunks())
    assert sum(map(len, chunks)) == 1680


def test_a_model_without_values_is_refused(tmp_path):
    path = written(tmp_path)
    with edited(path) as main:
        described = main.getcoldesc("DATA") | {"name": "MODEL_DATA", "dataManagerGroup": "MODEL"}
        main.addcols(tables.maketabdesc([tables.makecoldesc("MODEL_DATA", described)]))
        for row in range(1000):
            main.putcell("MODEL_DATA", row, main.getcell("DATA", row))
    with pytest.raises(InputError, match="MODEL_DATA has no value in 680 rows"):
        list(MeasurementSet(path, subtracted="MODEL_DATA").chunks())


def test_a_column_that_was_never_written_is_refused(tmp_path):
    path = written(tmp_path)
    with edited(path) as main:
        described = main.getcoldesc("DATA") | {"name": "CORRECTED_DATA", "dataManagerGroup": "C"}
        main.addcols(tables.maketabdesc([tables.makecoldesc("CORRECTED_DATA", described)]))
    with pytest.raises(InputError, match="column CORRECTED_DATA has no values; visibilities are"):
        MeasurementSet(path, column="CORRECTED_DATA")
