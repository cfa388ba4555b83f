"""Memory that copies of a process see."""

import numpy as np
import pytest

from uvshear.execution.shared_memory import shared_zeros


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
