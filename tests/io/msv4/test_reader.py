"""The reader of MSv4 stores."""

import pytest

from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.msv4.reader import Msv4Reader
from uvshear.io.readers import reader_of
from uvshear.io.reading import Reading

READER = Msv4Reader()


def test_zarr_stores_are_recognised(store, tmp_path):
    assert READER.recognises(store)
    assert not READER.recognises(tmp_path)
    assert not READER.recognises(written(tmp_path))
    assert isinstance(reader_of(store, Reading()), Msv4Reader)


def test_a_part_of_a_store_is_refused_in_detail(store):
    path = store / "field_0" / "antenna_xds"
    assert READER.recognises(path)
    with pytest.raises(InputError, match="give the store itself, not one of its subgroups"):
        READER.open(path, Reading())


def test_the_reading_reaches_the_store(store):
    data = READER.open(
        store, Reading(field="simulated", scans=(1,), heeds_flags=False, conjugates=True)
    )
    assert (data.column, data.field, data.scans) == ("DATA", "simulated", (1,))
    assert (data.heeds_flags, data.conjugates, data.subtracted) == (False, True, None)


def test_a_store_is_inspected_field_by_field(store):
    seen = READER.inspect(store, Reading())
    assert [(field.number, field.name) for field in seen.fields] == [(0, "simulated")]
