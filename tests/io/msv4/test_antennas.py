"""Antennas of a store by name."""

import numpy as np
import pytest

from tests.io.measurement_sets import simulated
from tests.io.msv4_stores import ANTENNAS
from uvshear.errors import InputError
from uvshear.io.msv4.antennas import baseline_names, read_antennas

GROUP = f"field_0/{ANTENNAS}"


def test_antennas_are_those_of_the_layout(store):
    layout = simulated().coverage.layout
    found = read_antennas([store / "field_0"])
    assert found.names == tuple(layout.antenna_names)
    np.testing.assert_allclose(found.positions, layout.positions)
    np.testing.assert_array_equal(found.diameters, layout.diameters)
    assert found.telescope == "ska-mid-aa1"
    assert found.numbers_of(["SKA036", "SKA001"]).tolist() == [1, 0]


def test_partitions_share_their_antennas(tree, write):
    for group in [name for name in tree if name.startswith("field_0")]:
        tree[group.replace("field_0", "other")] = tree[group]
    tree[GROUP] = tree[GROUP].isel(antenna_name=slice(0, 3))
    path = write()
    found = read_antennas([path / "field_0", path / "other"])
    assert len(found.names) == 8
    # the first partition has baselines to five more, of which it does not tell the positions
    assert np.isnan(found.positions).any(axis=1).sum() == 5
    found = read_antennas([path / "other", path / "field_0"])
    assert np.isfinite(found.positions).all()


@pytest.mark.parametrize("missing", ["ANTENNA_POSITION", "antenna_name", "group"])
def test_visibilities_can_be_used_without_a_description_of_antennas(tree, write, missing):
    if missing == "group":
        del tree[GROUP]
    else:
        tree[GROUP] = tree[GROUP].drop_vars(missing)
    found = read_antennas([write() / "field_0"])
    assert len(found.names) == 8
    assert np.isnan(found.positions).all()


def test_a_diameter_that_is_not_known_is_0(tree, write):
    tree[GROUP]["ANTENNA_DISH_DIAMETER"][2] = np.nan
    assert read_antennas([write() / "field_0"]).diameters.tolist() == [
        15.0,
        15,
        0,
        15,
        15,
        15,
        15,
        15,
    ]


def test_two_antennas_of_one_name_are_refused(tree, write):
    names = tree[GROUP]["antenna_name"].values.copy()
    names[3] = names[2]
    tree[GROUP] = tree[GROUP].assign_coords(antenna_name=names)
    with pytest.raises(InputError, match="two antennas are called 'SKA046'; the names must differ"):
        read_antennas([write() / "field_0"])


def test_baselines_need_two_names(tmp_path, tree):
    for broken in (
        tree["field_0"].drop_vars("baseline_antenna2_name"),
        tree["field_0"].assign_coords(baseline_antenna2_name="SKA001"),
    ):
        with pytest.raises(
            InputError, match="has no coordinate baseline_antenna2_name with one name"
        ):
            baseline_names(tmp_path, broken)
