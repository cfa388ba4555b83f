"""Memory that copies of a process see."""

import gc
import mmap
import os
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uvshear.execution.shared_memory import Region, common_region, reserve_region, shared_zeros

PAGE = mmap.PAGESIZE


def test_it_is_an_array_of_zeros_that_can_be_written() -> None:
    found = shared_zeros((3, 4), np.float32)
    assert (found.shape, found.dtype) == ((3, 4), np.float32)
    np.testing.assert_array_equal(found, 0.0)
    found[1, 2] = 5.0
    assert found.sum() == 5.0


def test_memory_that_could_not_be_shared_is_never_given() -> None:
    with pytest.raises(MemoryError, match="bytes of shared memory"):
        shared_zeros((2**20, 2**20, 2**10), np.float64)


def test_an_empty_array_is_possible() -> None:
    assert shared_zeros((0,), np.float64).shape == (0,)


def test_arrays_of_a_region_do_not_overlap_and_lie_where_they_are_said_to() -> None:
    region = Region(8 * PAGE)
    first, second = region.zeros(PAGE + 1), region.zeros(100)
    first[:], second[:] = 1, 2
    assert first.sum() == PAGE + 1
    assert (region.place_of(first), region.place_of(second)) == (0, 2 * PAGE)
    assert region.place_of(second[7:]) == 2 * PAGE + 7
    assert region.place_of(np.zeros(3)) is None
    assert bytes(region.at(2 * PAGE, 2)) == b"\x02\x02"


def test_memory_comes_back_when_no_view_of_an_array_is_left() -> None:
    region = Region(4 * PAGE)
    view = region.zeros(3 * PAGE).view(np.float64)[5:9]
    view[:] = 1.0
    with pytest.raises(MemoryError, match="bytes of shared memory"):
        region.zeros(2 * PAGE)
    del view
    gc.collect()
    found = region.zeros(4 * PAGE)
    assert found.sum() == 0


@settings(deadline=None, max_examples=50)
@given(st.lists(st.tuples(st.integers(1, 4 * PAGE), st.integers(0, 5)), max_size=60))
def test_arrays_that_come_and_go_keep_their_values(steps: list[tuple[int, int]]) -> None:
    region, held = Region(16 * PAGE), {}
    for number, (size, slot) in enumerate(steps):
        held.pop(slot, None)
        try:
            array = region.zeros(size)
        except MemoryError:
            # Six arrays of at most four pages leave no gap of four pages at the worst.
            assert sum(-(-len(array) // PAGE) for array, _ in held.values()) + 4 > 16 / 2
            continue
        assert not array.any()
        array[:] = number % 256
        held[slot] = array, number % 256
        for array, value in held.values():
            assert (array == value).all()


def test_a_copy_that_drops_an_array_leaves_it_to_the_others() -> None:
    region = Region(4 * PAGE)
    array = region.zeros(PAGE)
    array[:] = 3
    copy = os.fork()
    if copy == 0:
        del array
        gc.collect()
        os._exit(0)
    assert os.waitpid(copy, 0)[1] == 0
    assert (array == 3).all()


def test_arrays_lie_in_the_common_region_once_there_is_one() -> None:
    assert reserve_region()
    region = common_region()
    assert region is not None
    assert reserve_region()
    assert common_region() is region
    assert region.place_of(shared_zeros((3,), np.float64)) is not None


def test_a_copy_takes_no_arrays_from_the_region_of_its_parent() -> None:
    assert reserve_region()
    copy = os.fork()
    if copy == 0:
        found = shared_zeros((3,), np.float64)
        os._exit(int(common_region() is not None or found.any()))
    assert os.waitpid(copy, 0)[1] == 0


LIMITED = """
import resource
from uvshear.execution.shared_memory import common_region, reserve_region, shared_zeros
import numpy as np
resource.setrlimit(resource.RLIMIT_AS, (2**32, 2**32))
assert not reserve_region()
assert common_region() is None
assert shared_zeros((5,), np.float64).sum() == 0
"""


def test_without_enough_addresses_there_is_no_common_region() -> None:
    assert resource.getrlimit(resource.RLIMIT_AS)[0] == resource.RLIM_INFINITY
    source = Path(__file__).parents[2] / "src"
    subprocess.run([sys.executable, "-c", LIMITED], check=True, env={"PYTHONPATH": str(source)})
