"""Blocks of a partition: how much of the store is read at once."""

import numpy as np
import pytest

import uvshear.io.msv4.blocks
from uvshear.io.msv4.blocks import BlockChoice, read_blocks, rows_per_block
from uvshear.io.msv4.partition import read_partition

ROW = 32 * 4 * 2 + 64
"""Bytes that are reckoned for a row of the store."""


def choice(steps=None):
    antennas = np.column_stack([np.arange(28), np.arange(28) + 1])
    chosen = np.ones(60, bool) if steps is None else np.isin(np.arange(60), steps)
    return BlockChoice(chosen, antennas, "WEIGHT", None, True, 1.0)


@pytest.fixture
def pieces(monkeypatch):
    """The times and baselines of VISIBILITY that are read together."""
    read = []
    original = uvshear.io.msv4.blocks._BlockReader._visibilities

    def counted(self, name, place, shape):
        read.append((place["time"], place["baseline_id"]))
        return original(self, name, place, shape)

    monkeypatch.setattr(uvshear.io.msv4.blocks._BlockReader, "_visibilities", counted)
    return read


def chunked(tree, write, **chunks):
    for name in ("VISIBILITY", "WEIGHT", "FLAG", "UVW"):
        variable = tree["field_0"][name]
        sizes = [chunks.get(axis, size) for axis, size in variable.sizes.items()]
        variable.encoding["chunks"] = tuple(sizes)
    return read_partition(write() / "field_0", "DATA")


def test_whole_parts_of_the_store_are_read_together(tree, write, pieces):
    partition = chunked(tree, write, time=7)
    rows = 28 * 20
    blocks = list(read_blocks(partition, choice(), rows * ROW))
    assert [times.start for times, _ in pieces] == [0, 14, 28, 42, 56]
    assert sum(map(len, blocks)) == 1680


def test_a_part_of_moderate_size_is_read_once_and_divided(tree, write, pieces):
    partition = chunked(tree, write, time=60)
    blocks = list(read_blocks(partition, choice(), 100 * ROW))
    assert len(pieces) == 1
    assert max(map(len, blocks)) == 100
    assert len(blocks) == 17


def test_a_large_part_is_read_several_times(tree, write, pieces, monkeypatch):
    monkeypatch.setattr(uvshear.io.msv4.blocks, "HELD", 1)
    partition = chunked(tree, write, time=60)
    blocks = list(read_blocks(partition, choice(), 100 * ROW))
    assert [times for times, _ in pieces][:2] == [slice(0, 3), slice(3, 6)]
    assert max(map(len, blocks)) == 84


def test_one_time_may_be_more_than_fits(tree, write, pieces):
    partition = chunked(tree, write, time=1)
    blocks = list(read_blocks(partition, choice(), 10 * ROW))
    assert max(map(len, blocks)) == 10
    assert pieces[:3] == [
        (slice(0, 1), slice(0, 10)),
        (slice(0, 1), slice(10, 20)),
        (slice(0, 1), slice(20, 28)),
    ]
    assert sum(map(len, blocks)) == 1680


def test_times_that_are_not_chosen_are_not_read(tree, write, pieces):
    partition = chunked(tree, write, time=10)
    blocks = list(read_blocks(partition, choice([13, 15, 59]), 280 * ROW))
    assert [times for times, _ in pieces] == [slice(13, 16), slice(59, 60)]
    assert [len(block) for block in blocks] == [56, 28]


def test_a_row_takes_the_memory_of_all_correlations(store):
    partition = read_partition(store / "field_0", "DATA")
    assert rows_per_block(partition, 10 * ROW) == 10
    assert rows_per_block(partition, 1) == 1


def test_the_longest_time_of_a_row_s_samples_counts(tree, write):
    partition = tree["field_0"]
    times = np.full((60, 28, 4, 2), 5.0)
    times[0, 0, 1, 0], times[0, 1] = 8.0, np.nan
    times[0, 2, 0, 0] = np.nan
    axes = ("time", "baseline_id", "frequency", "polarization")
    partition["EFFECTIVE_INTEGRATION_TIME"] = (axes, times)
    (block,) = read_blocks(read_partition(write() / "field_0", "DATA"), choice(), 2**25)
    # A row without any is taken to be averaged over the nominal time, one minute.
    np.testing.assert_array_equal(block.integrations.interval[:4], [8.0, 60.0, 5.0, 5.0])


def test_nominal_times_of_each_row_are_used_where_there_are_no_others(tree, write):
    partition = tree["field_0"].drop_vars("EFFECTIVE_INTEGRATION_TIME")
    nominal = np.full((60, 28), 4.0)
    nominal[3, 5] = 12.0
    partition["INTEGRATION_TIME"] = (("time", "baseline_id"), nominal)
    partition["time"].attrs["integration_time"] = {"data": np.nan}
    tree["field_0"] = partition
    (block,) = read_blocks(read_partition(write() / "field_0", "DATA"), choice(), 2**25)
    np.testing.assert_array_equal(block.integrations.interval, nominal.ravel())
