"""Checks of variables and attributes."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from uvshear.errors import InputError
from uvshear.io.msv4.variables import check_dimensions, numbers, quantity, texts, unit_of

PLACE = Path("store/group")
GROUP = xr.Dataset(
    {
        "GAIN": (("time", "antenna"), np.arange(6, dtype="f4").reshape(2, 3)),
        "NOTE": ("time", ["a", "b"]),
    },
    coords={
        "name": ("antenna", [" m0 ", "m1", "m2"]),
        "label": ("time", np.array([b"x", 3], object)),
    },
)


def test_numbers_come_in_the_order_that_is_asked_for():
    found = numbers(PLACE, GROUP, "GAIN", ("antenna", "time"))
    np.testing.assert_array_equal(found, [[0, 3], [1, 4], [2, 5]])
    assert found.dtype == float


@pytest.mark.parametrize(
    ("name", "dimensions", "message"),
    [
        ("LOSS", ("time",), "store/group: has no variable LOSS; it is needed"),
        ("GAIN", ("time",), r"GAIN has the dimensions \(time, antenna\); \(time\) are needed"),
        ("NOTE", ("time",), "NOTE does not hold numbers but <U1"),
    ],
)
def test_other_variables_are_refused(name, dimensions, message):
    with pytest.raises(InputError, match=message):
        numbers(PLACE, GROUP, name, dimensions)


def test_some_dimensions_are_enough_where_all_are_not_needed():
    check_dimensions(PLACE, "FLAG", ("time",), ("time", "frequency"), all_of=False)
    with pytest.raises(InputError, match=r"\(time, frequency\) are possible"):
        check_dimensions(PLACE, "FLAG", ("antenna",), ("time", "frequency"), all_of=False)


def test_texts_lose_blanks_at_their_ends():
    assert texts(PLACE, GROUP, "name") == ("m0", "m1", "m2")
    assert len(texts(PLACE, GROUP, "label")) == 2


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ({"data": 2.5, "attrs": {"units": "s"}}, [2.5]),
        ({"data": [1.0, 2.0]}, [1.0, 2.0]),
        (3, [3.0]),
        ({"data": np.nan}, None),
        ({"data": "wide"}, None),
        ({"data": []}, None),
        ({"value": 1.0}, None),
        ([[1.0], [2.0, 3.0]], None),
        (None, None),
    ],
)
def test_a_quantity_is_numbers_or_nothing(value, expected):
    found = quantity({"width": value}, "width")
    assert expected == (None if found is None else found.tolist())


@pytest.mark.parametrize(
    ("units", "expected"), [("Hz", "Hz"), (["Hz"], "Hz"), ([], "[]"), (1, "1")]
)
def test_a_unit_may_be_in_a_list(units, expected):
    assert unit_of({"units": units}) == expected
    assert unit_of({}) == ""
