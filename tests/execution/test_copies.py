"""An executor of copies."""

import os

import pytest

from tests.execution import tasks as work
from uvshear.errors import InputError
from uvshear.execution import Copies


def test_distributed_tasks_run_in_copies() -> None:
    list(Copies(2).distribute(work.process, None, range(2)))
    seen = set(Copies(2).distribute(work.process, None, range(8)))
    assert os.getpid() not in seen
    assert len(seen) == 2


def test_nothing_that_is_shared_is_sent(tmp_path) -> None:
    shared = work.CountsItsPickles(tmp_path / "sent.txt")
    assert list(Copies(2).distribute(work.nothing, shared, range(20))) == list(range(20))
    assert not shared.log.exists()


def test_what_shares_memory_runs_in_this_process() -> None:
    assert set(Copies(2).map(lambda _: os.getpid(), range(4))) == {os.getpid()}


def test_the_count_is_the_number_of_workers() -> None:
    assert Copies(3).workers == 3
    assert Copies(3).at_most(2) == Copies(2)
    assert Copies(3).at_most(0) == Copies(1)


@pytest.mark.parametrize("count", [0, -1])
def test_a_count_below_one_is_refused(count: int) -> None:
    with pytest.raises(InputError, match="one or more are needed"):
        Copies(count)
