"""An executor of copies."""

import os

from tests.execution import tasks as work
from uvshear.execution import Copies


def test_distributed_tasks_run_in_this_process_and_in_copies() -> None:
    list(Copies(3).distribute(work.brief, None, range(2)))
    seen = {process for _, process in Copies(3).distribute(work.brief, None, range(40))}
    assert os.getpid() in seen
    assert len(seen) == 3


def test_nothing_that_is_shared_is_sent(tmp_path) -> None:
    shared = work.CountsItsPickles(tmp_path / "sent.txt")
    assert list(Copies(2).distribute(work.nothing, shared, range(20))) == list(range(20))
    assert not shared.log.exists()


def test_what_shares_memory_runs_in_this_process() -> None:
    assert set(Copies(2).map(lambda _: os.getpid(), range(4))) == {os.getpid()}
