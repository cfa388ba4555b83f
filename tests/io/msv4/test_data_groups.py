"""Variables that belong together."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from uvshear.errors import InputError
from uvshear.io.msv4.data_groups import (
    CORRELATED_DIMENSIONS,
    DataGroup,
    choose_data_group,
    visibility_variables,
)

PLACE = Path("store/group")
BASE = DataGroup("VISIBILITY", "WEIGHT", "FLAG", "UVW", "field_and_source_base_xds")


def partition(*names, dtype="c8", dimensions=CORRELATED_DIMENSIONS, **groups):
    content = {name: (dimensions, np.zeros((1,) * len(dimensions), dtype)) for name in names}
    return xr.Dataset(content, attrs={"data_groups": groups} if groups else {})


def test_without_data_groups_the_names_are_those_of_the_schema():
    assert choose_data_group(PLACE, partition("VISIBILITY"), "DATA") == BASE


def test_a_data_group_names_all_of_its_variables():
    mine = {
        "correlated_data": "SELFCAL",
        "weight": "W",
        "flag": "F",
        "uvw": "BASELINES",
        "field_and_source": "partition_000/field_and_source_mine_xds",
    }
    found = partition("VISIBILITY", "SELFCAL", base={"correlated_data": "VISIBILITY"}, mine=mine)
    expected = DataGroup("SELFCAL", "W", "F", "BASELINES", "field_and_source_mine_xds")
    assert choose_data_group(PLACE, found, "mine") == expected
    assert choose_data_group(PLACE, found, "SELFCAL") == expected
    assert choose_data_group(PLACE, found, "DATA") == BASE


def test_a_variable_outside_of_all_groups_has_what_belongs_to_the_first():
    base = {"correlated_data": "VISIBILITY", "weight": "W"}
    found = choose_data_group(
        PLACE, partition("VISIBILITY", "CORRECTED_DATA", base=base), "CORRECTED_DATA"
    )
    assert (found.visibilities, found.weights) == ("CORRECTED_DATA", "W")


def test_other_kinds_of_variables_are_refused():
    with pytest.raises(InputError, match="holds float32, not complex visibilities"):
        choose_data_group(PLACE, partition("VISIBILITY", dtype="f4"), "DATA")
    flat = partition("VISIBILITY", dimensions=("time", "frequency"))
    with pytest.raises(InputError, match=r"VISIBILITY has the dimensions \(time, frequency\)"):
        choose_data_group(PLACE, flat, "DATA")
    with pytest.raises(
        InputError, match="no variable DATA; the variables that hold visibilities are A"
    ):
        choose_data_group(PLACE, partition("A"), "DATA")


@pytest.mark.parametrize("groups", [[1], {"base": 3}, "base"])
def test_data_groups_that_are_none_are_not_heeded(groups):
    found = partition("VISIBILITY")
    found.attrs["data_groups"] = groups
    assert choose_data_group(PLACE, found, "DATA") == BASE


def test_visibilities_are_complex_and_have_four_dimensions():
    found = partition("VISIBILITY", "SELFCAL").assign(FLAG=("time", np.zeros(1, "c8")))
    assert visibility_variables(found) == ("VISIBILITY", "SELFCAL")
