"""Times with their fields and scans."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from astropy.time import Time

from uvshear.errors import InputError
from uvshear.io.msv4.timeline import read_timeline

PLACE = Path("store/group")


def partition(values=(1e9, 1e9 + 8), attrs=None, **coordinates):
    attrs = {"units": "s", "format": "unix"} if attrs is None else attrs
    return xr.Dataset(coords={"time": ("time", list(values), attrs), **coordinates})


@pytest.mark.parametrize(
    ("kind", "unit"), [("unix", "s"), ("mjd", "d"), ("mjd", "s"), ("cxcsec", "s"), ("gps", "s")]
)
def test_every_format_counts_modified_julian_days(kind, unit):
    start = Time("2010-05-03T01:02:03", scale="utc")
    value = getattr(start, kind) * (86400 if (kind, unit) == ("mjd", "s") else 1)
    found = read_timeline(PLACE, partition([value], {"format": kind, "units": unit}), ["a"])
    # leap seconds are neglected
    assert found.time[0] == pytest.approx(start.mjd * 86400, abs=70)
    if kind in {"unix", "mjd"}:
        assert found.time[0] == pytest.approx(start.mjd * 86400, abs=1e-3)


def test_times_are_in_seconds_of_unix_unless_they_say_otherwise():
    found = read_timeline(PLACE, partition(attrs={}), ["a"])
    np.testing.assert_array_equal(found.time, np.array([1e9, 1e9 + 8]) + 40587 * 86400)
    assert found.integration is None


@pytest.mark.parametrize("attrs", [{"format": "jd"}, {"units": "h"}, {"units": ["min"]}])
def test_other_formats_are_refused(attrs):
    with pytest.raises(InputError, match="store/group: time is in the format"):
        read_timeline(PLACE, partition(attrs=attrs), ["a"])


def test_integrations_have_a_length():
    attrs = {"integration_time": {"data": 8.0, "attrs": {"units": "s"}}}
    assert read_timeline(PLACE, partition(attrs=attrs), ["a"]).integration == 8.0


def test_fields_and_scans_choose_times():
    found = read_timeline(
        PLACE,
        partition(
            (1, 2, 3), field_name=("time", ["a", "b", "a"]), scan_name=("time", ["1", "1", "2"])
        ),
        ["a", "b"],
    )
    assert len(found) == 3
    assert found.chosen(["a"], None).tolist() == [True, False, True]
    assert found.chosen(["a"], (2,)).tolist() == [False, False, True]
    assert found.chosen(["a", "b"], (1, 2)).all()


def test_one_field_need_not_be_named_at_each_time():
    assert read_timeline(PLACE, partition(), ["only"]).fields == ("only", "only")
    assert read_timeline(PLACE, partition(field_name="only"), ["a", "b"]).fields == ("only", "only")
    with pytest.raises(
        InputError, match="has no coordinate field_name with one name for each time"
    ):
        read_timeline(PLACE, partition(), ["a", "b"])
