"""The reader of Measurement Sets."""

import pytest

from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.measurement_set.reader import MeasurementSetReader
from uvshear.io.reading import Reading

READER = MeasurementSetReader()


def test_casacore_tables_are_recognised(tmp_path):
    path = written(tmp_path)
    assert READER.recognises(path)
    assert not READER.recognises(tmp_path)
    assert not READER.recognises(tmp_path / "absent.ms")


def test_a_table_that_is_no_measurement_set_is_refused_in_detail(tmp_path):
    path = written(tmp_path) / "FIELD"
    assert READER.recognises(path)
    with pytest.raises(InputError, match="give the Measurement Set itself"):
        READER.open(path, Reading())


def test_the_reading_reaches_the_set(tmp_path):
    path = written(tmp_path)
    data = READER.open(
        path, Reading(field="simulated", scans=(1,), heeds_flags=False, conjugates=True)
    )
    assert (data.column, data.field, data.scans) == ("DATA", "simulated", (1,))
    assert (data.heeds_flags, data.conjugates, data.subtracted) == (False, True, None)


def test_a_set_is_inspected_field_by_field(tmp_path):
    seen = READER.inspect(written(tmp_path), Reading())
    assert [field.name for field in seen.fields] == ["simulated"]
