"""Objects that copies of this process receive after they were made."""

import os
import pickle

import numpy as np
import pytest

from uvshear.execution.handing_over import LARGE, HandedOver, hand_over
from uvshear.execution.shared_memory import reserve_region, shared_zeros

CONTENT = {
    "text": "of no interest",
    "small": np.arange(5),
    "large": np.arange(LARGE, dtype=np.float32).reshape(4, -1),
    "bytes": np.arange(3 * LARGE, dtype=np.uint8)[1:],
    "strided": np.arange(4 * LARGE)[::2],
    "columns": np.asfortranarray(np.arange(2.0 * LARGE).reshape(2, -1)),
    "empty": np.zeros((0, 3), np.complex64),
    "nothing": None,
}


@pytest.fixture(autouse=True)
def _region():
    assert reserve_region()


def _same(found: object, expected: object) -> bool:
    if isinstance(expected, np.ndarray):
        same = isinstance(found, np.ndarray) and (found.dtype, found.shape) == (
            expected.dtype,
            expected.shape,
        )
        return same and np.array_equal(found, expected)
    return found == expected


def test_a_received_object_equals_the_one_that_was_handed_over() -> None:
    handed, _kept = hand_over(CONTENT)
    found = handed.received()
    assert found.keys() == CONTENT.keys()
    for name, expected in CONTENT.items():
        assert _same(found[name], expected), name


def test_what_copies_are_told_is_short() -> None:
    handed, _kept = hand_over([np.zeros(2**20), b"x" * 2**20])
    assert len(pickle.dumps(handed)) < 1000


def test_arrays_of_the_region_are_shared_and_others_are_not() -> None:
    shared, own = shared_zeros((LARGE,), np.float64), np.zeros(LARGE)
    handed, _kept = hand_over((shared[10:], own, shared))
    part, copied, whole = handed.received()
    shared[12], own[:] = 4.0, 9.0
    assert part[2] == 4.0
    assert whole[12] == 4.0
    assert not copied.any()
    part[0] = 5.0
    assert shared[10] == 5.0


def test_small_arrays_of_the_region_are_shared_too() -> None:
    shared = shared_zeros((1,), np.float64)
    handed, _kept = hand_over([shared])
    (found,) = handed.received()
    shared[0] = 2.0
    assert found[0] == 2.0


def test_an_array_that_must_not_be_written_stays_so() -> None:
    fixed, free = np.ones(LARGE), np.ones(LARGE)
    fixed.flags.writeable = False
    handed, _kept = hand_over((fixed, free))
    assert [array.flags.writeable for array in handed.received()] == [False, True]


def test_a_copy_receives_what_was_made_after_it() -> None:
    ours, theirs = os.pipe()
    copy = os.fork()
    if copy == 0:
        os.close(theirs)
        handed = pickle.loads(os.read(ours, 10_000))
        assert isinstance(handed, HandedOver)
        large, shared = handed.received()
        shared[0] = large.sum()
        os._exit(0)
    os.close(ours)
    shared = shared_zeros((1,), np.float64)
    handed, _kept = hand_over((np.ones(LARGE), shared))
    os.write(theirs, pickle.dumps(handed))
    os.close(theirs)
    assert os.waitpid(copy, 0)[1] == 0
    assert shared[0] == LARGE


def test_what_cannot_be_pickled_is_not_handed_over() -> None:
    with pytest.raises((AttributeError, TypeError, pickle.PicklingError)):
        hand_over(lambda: None)
