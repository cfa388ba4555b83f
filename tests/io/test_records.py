"""JSON files that commands read."""

import pytest

from uvshear.errors import InputError
from uvshear.io.outputs import write_json
from uvshear.io.records import finite, read_record


def test_a_record_that_was_written_is_read(tmp_path):
    path = tmp_path / "record.json"
    write_json(path, {"m": 0.5, "c": float("nan"), "list": [1.0, float("inf")], "words": "yes"})
    record = read_record(path, "a record")
    assert record == {"m": 0.5, "c": None, "list": [1.0, None], "words": "yes"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1, 2]", "is not a record"),
        ("[" * 100_000, "nested too deeply"),
        ('{"n": 1' + 5000 * "0" + "}", "cannot be read as JSON"),
        (" " * 10_000_001, "is too large"),
        ("{", "cannot be read as JSON"),
        ('{"a": {"m": 1, "c": 2, "m": 1}}', "'m' is given more than once"),
        ("\xff", "cannot be read"),
    ],
)
def test_a_file_without_names_and_values_is_refused(tmp_path, text, message):
    path = tmp_path / "record.json"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match=message):
        read_record(path, "a record")


def test_a_mark_of_the_byte_order_is_no_part_of_a_record(tmp_path):
    path = tmp_path / "record.json"
    path.write_bytes(b"\xef\xbb\xbf{}")
    assert read_record(path, "a record") == {}


def test_a_directory_is_no_record(tmp_path):
    with pytest.raises(InputError, match=r"cannot be read as JSON: .*Is a directory"):
        read_record(tmp_path, "a record")


def test_a_file_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_record(tmp_path / "absent.json", "a record")


@pytest.mark.parametrize("value", [None, True, "1", float("nan"), float("inf"), 10**400, [1.0]])
def test_anything_but_a_finite_number_is_none(value):
    assert finite({"m": value}, "m") is None


def test_finite_numbers_are_returned():
    assert finite({"m": 2}, "m") == 2.0
    assert finite({}, "m") is None
