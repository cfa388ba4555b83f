"""Groups of zarr stores, found without xarray."""

import json
import subprocess
import sys

import pytest

from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.msv4.groups import attributes, correlated_groups, is_zarr


def group(path, **attrs):
    """A group of format 3 with some attributes."""
    path.mkdir(parents=True, exist_ok=True)
    content = {"node_type": "group", "zarr_format": 3, "attributes": attrs}
    (path / "zarr.json").write_text(json.dumps(content), encoding="utf-8")
    return path


def old_group(path, **attrs):
    """A group of format 2 with some attributes."""
    path.mkdir(parents=True, exist_ok=True)
    (path / ".zgroup").write_text('{"zarr_format": 2}', encoding="utf-8")
    (path / ".zattrs").write_text(json.dumps(attrs), encoding="utf-8")
    return path


@pytest.mark.parametrize("make", [group, old_group])
def test_zarr_is_told_apart_from_other_directories(tmp_path, make):
    assert is_zarr(make(tmp_path / "store"))
    assert not is_zarr(tmp_path)
    assert not is_zarr(tmp_path / "absent")
    assert not is_zarr(written(tmp_path))


@pytest.mark.parametrize("make", [group, old_group])
def test_groups_of_visibilities_are_found_in_order_and_not_below_one_another(tmp_path, make):
    root = make(tmp_path / "store", type="processing_set")
    second = make(root / "b", type="visibility")
    first = make(root / "a" / "deep", type="visibility")
    make(root / "a")
    make(second / "copy", type="visibility")
    make(root / "c", type="spectrum")
    (root / "files").mkdir()
    assert correlated_groups(root) == (first, second)
    assert correlated_groups(second) == (second,)
    assert attributes(root) == {"type": "processing_set"}


@pytest.mark.parametrize(
    ("attrs", "message"),
    [
        ({}, "a zarr store, but not an MSv4 store"),
        ({"type": "processing_set"}, "a zarr store, but not an MSv4 store"),
        ({"type": "antenna"}, "an MSv4 group of the type 'antenna'; give the store itself"),
        ({"type": "spectrum"}, "an MSv4 store of single-dish spectra"),
        ({"type": ["visibility"]}, "an MSv4 group of the type"),
    ],
)
def test_a_store_of_something_else_is_refused(tmp_path, attrs, message):
    path = group(tmp_path / "store", **attrs)
    with pytest.raises(InputError, match=message) as caught:
        correlated_groups(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_an_array_is_no_group(tmp_path):
    path = group(tmp_path / "array")
    (path / "zarr.json").write_text('{"node_type": "array"}', encoding="utf-8")
    with pytest.raises(InputError, match="not an MSv4 store"):
        correlated_groups(path)


@pytest.mark.parametrize("content", [b"{", b"\xff", b"[1]", b"[" * 100_000])
def test_metadata_that_are_no_json_are_refused(tmp_path, content):
    path = group(tmp_path / "store")
    (path / "zarr.json").write_bytes(content)
    with pytest.raises(InputError, match=r"zarr.json: metadata that") as caught:
        correlated_groups(path)
    assert "\n" not in str(caught.value)


def test_a_set_is_read_without_xarray(tmp_path):
    path = written(tmp_path)
    code = (
        "import sys; from uvshear.io.observations import open_observation;"
        f"next(open_observation({str(path)!r}).chunks());"
        "assert not {'xarray', 'zarr', 'pandas'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
