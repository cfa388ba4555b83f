"""Fields of a store: names and directions."""

import numpy as np
import pytest
import xarray as xr

from tests.io.msv4_stores import write_tree
from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.geometry.directions import PhaseCentre
from uvshear.io.msv4.fields import (
    FieldLabel,
    StoreField,
    choose_field,
    grouped,
    read_direction,
    read_field_names,
)

XRADIO = {"creator": {"software_name": "xradio"}}
TARGET = FieldLabel("deep", "deep", None)


def group_of(tmp_path, directions, name="fields", **attrs):
    """Write a subgroup with fields of these directions [rad]."""
    fields = xr.Dataset(
        {
            "FIELD_PHASE_CENTER_DIRECTION": (
                ("field_name", "sky_dir_label"),
                np.array(list(directions.values()), float),
                {"units": "rad", "frame": "fk5"} | attrs,
            )
        },
        coords={"field_name": list(directions), "sky_dir_label": ["ra", "dec"]},
        attrs={"type": "field_and_source"},
    )
    write_tree({name: fields}, tmp_path / "store")
    return tmp_path / "store" / name


def labels(*names, attributes=XRADIO):
    return [FieldLabel.from_label(name, attributes) for name in names]


@pytest.mark.parametrize(
    ("label", "attributes", "expected"),
    [
        ("CDFS_2_5_0", XRADIO, ("CDFS_2_5", 0)),
        ("_3", XRADIO, ("", 3)),
        ("deep", XRADIO, ("deep", None)),
        ("CDFS_2_5", {"creator": {"software_name": "xarray-ms"}}, ("CDFS_2_5", None)),
        ("CDFS_2_5", {"creator": "xradio"}, ("CDFS_2_5", None)),
        ("CDFS_2_5", {}, ("CDFS_2_5", None)),
    ],
)
def test_xradio_adds_the_number_of_the_field_to_its_name(label, attributes, expected):
    found = FieldLabel.from_label(label, attributes)
    assert (found.name, found.number) == expected
    assert found.label == label


@pytest.fixture
def four(tmp_path):
    """Fields a (0), a (2) at one place, b (1) elsewhere, a (4) a second of arc away."""
    place = (1.0, -0.5)
    near = (1.0, -0.5 + ARCSEC)
    directions = {"a_0": place, "b_1": (2.0, 0.1), "a_2": place, "a_4": near}
    group = group_of(tmp_path, directions)
    return tmp_path, {label: [group] for label in labels("a_0", "b_1", "a_2", "a_4")}


@pytest.mark.parametrize(
    ("wanted", "names"),
    [
        ("b", ("b_1",)),
        ("b_1", ("b_1",)),
        (" b ", ("b_1",)),
        (1, ("b_1",)),
        ("1", ("b_1",)),
        (0, ("a_0",)),
        ("a_4", ("a_4",)),
    ],
)
def test_a_field_has_a_name_a_label_and_a_number(four, wanted, names):
    path, present = four
    assert choose_field(path, present, wanted).names_in_store == names


def test_names_of_one_place_are_grouped(four):
    path, present = four
    assert [field.names_in_store for field in grouped(path, present)] == [
        ("a_0", "a_2"),
        ("b_1",),
        ("a_4",),
    ]
    near = {label: places for label, places in present.items() if label.number in {0, 2}}
    field = choose_field(path, near, "a")
    assert (field.name, field.number, len(field.labels)) == ("a", 0, 2)
    assert choose_field(path, near, None) == field


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        (None, r"several fields, 0 \(a\), 1 \(b\), 2 \(a\), 4 \(a\); choose one with --field"),
        ("c", r"no rows of field c; the fields with rows are 0 \(a\)"),
        (3, "no rows of field 3; "),
        ("a", "field a is the name of several fields with different phase centres, a_0, a_2, a_4"),
    ],
)
def test_a_field_that_is_none_or_several_is_refused(four, wanted, message):
    path, present = four
    with pytest.raises(InputError, match=message):
        choose_field(path, present, wanted)


def test_a_name_may_be_a_number(tmp_path):
    group = group_of(tmp_path, {"7": (1.0, 0.0), "8": (2.0, 0.0)})
    present = {label: [group] for label in labels("7", "8", attributes={})}
    for wanted in (8, "8"):
        assert choose_field(tmp_path, present, wanted).phase_centre == PhaseCentre(2.0, 0.0)


def test_partitions_must_agree_on_a_direction(tmp_path):
    first = group_of(tmp_path, {"deep": (1.0, 0.0)}, "a")
    second = group_of(tmp_path, {"deep": (1.0, ARCSEC)}, "b")
    assert choose_field(tmp_path, {TARGET: [first, first]}, None) == StoreField(
        (TARGET,), PhaseCentre(1.0, 0.0)
    )
    with pytest.raises(InputError, match="one phase centre in store/a and another in store/b"):
        choose_field(tmp_path, {TARGET: [first, second]}, None)


def test_the_pointing_is_the_reference_where_there_is_one(tmp_path):
    group = group_of(tmp_path, {"deep": (1.0, 0.0)})
    assert read_direction(group, TARGET, wants_pointing=True) == PhaseCentre(1.0, 0.0)
    reference = xr.Dataset(
        {
            "FIELD_REFERENCE_CENTER_DIRECTION": (
                "sky_dir_label",
                [1.0, 0.01],
                {"units": ["rad"], "frame": "ICRS"},
            )
        }
    )
    write_tree({"fields": reference}, tmp_path / "store")
    assert read_direction(group, TARGET, wants_pointing=True) == PhaseCentre(1.0, 0.01)
    assert read_direction(group, TARGET) == PhaseCentre(1.0, 0.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frame": "galactic"}, "of field deep is in frame galactic; fk5 or icrs is needed"),
        ({"units": "deg"}, "is in deg; rad is needed"),
    ],
)
def test_another_frame_or_unit_is_refused(tmp_path, changes, message):
    with pytest.raises(InputError, match=message):
        read_direction(group_of(tmp_path, {"deep": (1.0, 0.0)}, **changes), TARGET)


@pytest.mark.parametrize("direction", [(np.nan, 0.0), (1.0, 2.0), (1.0, np.inf)])
def test_a_direction_that_is_none_is_refused(tmp_path, direction):
    with pytest.raises(InputError, match="radians are needed"):
        read_direction(group_of(tmp_path, {"deep": direction}), TARGET)


def test_a_field_that_is_not_described_is_refused(tmp_path):
    group = group_of(tmp_path, {"shallow": (1.0, 0.0)})
    with pytest.raises(
        InputError, match="has no field deep, and so no phase centre for it; its fields are shallow"
    ):
        read_direction(group, TARGET)
    with pytest.raises(InputError, match="there is no such group, and so no phase centre"):
        read_direction(tmp_path / "absent", TARGET)
    assert read_field_names(tmp_path / "absent") == ()
    assert read_field_names(group) == ("shallow",)


def test_a_field_that_moves_is_refused(tmp_path):
    group = group_of(tmp_path, {"deep": (1.0, 0.0)})
    write_tree(
        {"fields": xr.Dataset(attrs={"type": "field_and_source_ephemeris"})}, tmp_path / "store"
    )
    with pytest.raises(InputError, match="field deep moves"):
        read_direction(group, TARGET)


@pytest.mark.parametrize(
    ("dimensions", "shape", "message"),
    [
        (("time", "sky_dir_label"), (3, 2), "has the dimensions"),
        (("field_name", "sky_dir_label"), (1, 3), "has 3 numbers; right ascension and declination"),
    ],
)
def test_a_direction_of_another_shape_is_refused(tmp_path, dimensions, shape, message):
    fields = xr.Dataset(
        {"FIELD_PHASE_CENTER_DIRECTION": (dimensions, np.zeros(shape))},
        coords={"field_name": ["deep"]},
    )
    write_tree({"fields": fields}, tmp_path / "store")
    with pytest.raises(InputError, match=message):
        read_direction(tmp_path / "store" / "fields", TARGET)
