"""What describes a group of visibilities."""

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.io.msv4.partition import AveragingTimes, filled_weights, probed, read_partition

SAMPLES = ("time", "baseline_id", "frequency", "polarization")


def test_it_is_described(store):
    found = read_partition(store / "field_0", "DATA")
    assert len(found.timeline) == 60
    assert len(found.setup.channels) == 4
    assert found.baselines[0][:2] == ("SKA001", "SKA001")
    assert found.fields_group == store / "field_0" / "field_and_source_base_xds"
    assert found.times == AveragingTimes(has_exposure=True, is_exposed=False, is_nominal=True)
    assert found.averaging_notice is None
    assert filled_weights(found, [0, 30]) == "WEIGHT"


@pytest.mark.parametrize("version", ["4.0.1", "4.0.-9990", "4"])
def test_every_version_4_of_the_schema_is_read(tree, write, version):
    tree["field_0"].attrs["schema_version"] = version
    assert read_partition(write() / "field_0", "DATA")


def test_another_version_is_refused(tree, write):
    tree["field_0"].attrs["schema_version"] = "5.0.0"
    with pytest.raises(InputError, match=r"has version 5.0.0 of the schema; version 4 \(MSv4\)"):
        read_partition(write() / "field_0", "DATA")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("UVW", "has no variable UVW; the baselines are needed"),
        ("VISIBILITY", "no variable DATA; the variables that hold visibilities are none"),
        ("time", "has no variable time; it is needed"),
        ("frequency", "has no variable frequency; it is needed"),
        ("polarization", "has no variable polarization; it is needed"),
        ("baseline_antenna1_name", "has no coordinate baseline_antenna1_name"),
    ],
)
def test_a_missing_variable_is_named(tree, write, name, message):
    tree["field_0"] = tree["field_0"].drop_vars(name)
    with pytest.raises(InputError, match=f"field_0: .*{message}"):
        read_partition(write() / "field_0", "DATA")


@pytest.mark.parametrize(
    ("name", "variable", "message"),
    [
        (
            "UVW",
            (("time", "baseline_id"), np.zeros((60, 28))),
            r"UVW has the dimensions \(time, base",
        ),
        ("UVW", (("time", "baseline_id", "uvw_label"), np.full((60, 28, 3), "x")), "three numbers"),
        ("WEIGHT", (("time", "uvw_label"), np.ones((60, 3))), "WEIGHT has the dimensions"),
        ("WEIGHT", (SAMPLES, np.ones((60, 28, 4, 2), "c8")), "WEIGHT holds complex64; numbers are"),
        ("FLAG", ("time", np.full(60, "no")), "FLAG holds <U2; numbers are needed"),
    ],
)
def test_a_variable_of_another_kind_is_refused(tree, write, name, variable, message):
    tree["field_0"] = tree["field_0"].drop_vars(name).assign({name: variable})
    with pytest.raises(InputError, match=message):
        read_partition(write() / "field_0", "DATA")


def test_two_coordinates_of_a_baseline_are_refused(tree, write):
    tree["field_0"] = tree["field_0"].isel(uvw_label=slice(0, 2))
    with pytest.raises(
        InputError, match="UVW has 2 coordinates of the type float64; three numbers"
    ):
        read_partition(write() / "field_0", "DATA")


def test_exposures_are_judged_by_times_spread_over_the_partition(tree, write):
    tree["field_0"]["EFFECTIVE_INTEGRATION_TIME"][:] = np.nan
    tree["field_0"]["EFFECTIVE_INTEGRATION_TIME"][-1, 3] = 60.0
    assert read_partition(write() / "field_0", "DATA").times.is_exposed


def test_times_are_probed_from_the_first_to_the_last():
    steps = np.arange(100, 1000, 3)
    found = probed(steps)
    assert len(found) == 16
    assert (found[0], found[-1]) == (100, 997)
    assert set(found) <= set(steps.tolist())
    assert probed(np.arange(2)) == [0, 1]
    assert probed(np.arange(0)) == []
