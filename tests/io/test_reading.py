from tests.io.measurement_sets import written
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.reading import Reading


def test_a_set_is_opened_as_the_reading_says(tmp_path):
    path = written(tmp_path)
    reading = Reading(field=0, scans=(1,), heeds_flags=False, conjugates=True)
    opened = MeasurementSet.from_reading(path, reading)
    assert (opened.column, opened.field, opened.scans) == ("DATA", 0, (1,))
    assert opened.conjugates
    assert not opened.heeds_flags


def test_nothing_is_left_out_unless_it_is_said():
    reading = Reading()
    assert (reading.column, reading.field, reading.scans) == ("DATA", None, None)
    assert reading.heeds_flags
    assert not reading.conjugates
