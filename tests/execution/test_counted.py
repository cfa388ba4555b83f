"""Executors with a number of workers."""

import pytest

from uvshear.errors import InputError
from uvshear.execution import Copies, Processes, Threads

EACH = pytest.mark.parametrize("kind", [Copies, Processes, Threads])


@EACH
def test_the_count_is_the_number_of_workers(kind) -> None:
    assert kind(3).workers == 3
    assert kind(3).at_most(2) == kind(2)
    assert kind(3).at_most(5) == kind(3)
    assert kind(3).at_most(0) == kind(1)


@EACH
@pytest.mark.parametrize("count", [0, -1])
def test_a_count_below_one_is_refused(kind, count) -> None:
    with pytest.raises(InputError, match=f"{count} workers; one or more are needed"):
        kind(count)
