"""Groups opened with xarray."""

import sys

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.io.msv4.opening import open_group, zarr_errors
from uvshear.io.observations import open_observation


def test_numbers_of_seconds_stay_numbers(store):
    with open_group(store / "field_0") as group:
        assert group["time"].dtype == np.dtype("f8")
        assert group["EFFECTIVE_INTEGRATION_TIME"].dtype == np.dtype("f8")


@pytest.mark.parametrize("package", ["xarray", "zarr"])
def test_a_missing_package_is_named_with_the_extra_that_brings_it(store, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=r"pip install 'uvshear\[msv4\]'") as caught:
        open_observation(store)
    assert package in str(caught.value)
    assert "\n" not in str(caught.value)


def test_any_error_of_the_packages_is_one_line(tmp_path):
    def fail(error):
        with zarr_errors(tmp_path, "FLAG"):
            raise error

    with pytest.raises(InputError, match="FLAG cannot be read \\(two lines\\)"):
        fail(RuntimeError("two\nlines"))
    with pytest.raises(InputError, match="FLAG cannot be read \\(KeyError\\)"):
        fail(KeyError())
    with pytest.raises(InputError, match=r"^itself$"):
        fail(InputError("itself"))


def test_damaged_metadata_of_an_array_are_refused(store):
    (store / "field_0" / "UVW" / "zarr.json").write_text('{"zarr_format": 3}', encoding="utf-8")
    with pytest.raises(InputError) as caught:
        open_observation(store)
    assert str(caught.value).startswith(f"{store}/field_0: ")
    assert "\n" not in str(caught.value)


def test_a_damaged_part_of_an_array_is_refused_when_it_is_read(store):
    for part in (store / "field_0" / "VISIBILITY" / "c").rglob("*"):
        if part.is_file():
            part.write_bytes(part.read_bytes()[:50])
    opened = open_observation(store)
    with pytest.raises(InputError, match="field_0: VISIBILITY cannot be read"):
        list(opened.chunks())
