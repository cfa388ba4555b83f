"""Metadata of a store."""

import numpy as np
import pytest

from tests.io.measurement_sets import PHASE_CENTRE
from uvshear.errors import InputError
from uvshear.io.msv4.header import check_scans, fields_with_rows, read_header, read_partitions


def test_the_metadata_are_read_once(store):
    header = read_header(store, "DATA", None)
    assert header.phase_centre == PHASE_CENTRE
    assert [one.group.name for one in header.partitions] == ["field_0"]
    assert header.weights == ("WEIGHT",)
    assert len(header.antennas.names) == 8


def test_only_groups_with_the_field_are_read(tree, write):
    for group in [name for name in tree if name.startswith("field_0")]:
        tree[group.replace("field_0", "another")] = tree[group].copy(deep=True)
    labels = np.array(["other_7"])
    partition, fields = tree["another"], tree["another/field_and_source_base_xds"]
    partition = partition.assign_coords(field_name=("time", np.repeat(labels, 60)))
    tree["another"] = partition
    tree["another/field_and_source_base_xds"] = fields.assign_coords(field_name=labels)
    path = write()
    header = read_header(path, "DATA", "simulated")
    assert [one.group.name for one in header.partitions] == ["field_0"]
    everything = read_partitions(path, "DATA")
    assert [label.label for label in fields_with_rows(everything)] == ["simulated_0", "other_7"]


def test_a_store_without_times_is_refused(tree, write):
    tree["field_0"] = tree["field_0"].isel(time=slice(0, 0))
    with pytest.raises(InputError, match="has no rows; an observation with visibilities is needed"):
        read_header(write(), "DATA", None)


def test_a_store_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file; the path of an MSv4 store is needed"):
        read_header(tmp_path / "absent", "DATA", None)


def test_scans_are_compared_by_name(store):
    partitions = read_partitions(store, "DATA")
    check_scans(store, partitions, (1,))
    with pytest.raises(InputError, match="no rows of scan 2; the scans with rows are 1"):
        check_scans(store, partitions, (1, 2))
