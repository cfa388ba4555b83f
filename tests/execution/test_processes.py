"""Tasks in processes."""

import os

from tests.execution import tasks as work
from uvshear.execution import Processes


def test_distributed_tasks_run_in_other_processes() -> None:
    seen = set(Processes(2).distribute(work.process, None, range(4)))
    assert os.getpid() not in seen
    assert len(seen) <= 2


def test_what_shares_memory_runs_in_this_process() -> None:
    assert set(Processes(2).map(lambda _: os.getpid(), range(4))) == {os.getpid()}


def test_what_is_shared_is_sent_to_each_process_once(tmp_path) -> None:
    shared = work.CountsItsPickles(tmp_path / "sent.txt")
    assert list(Processes(2).distribute(work.nothing, shared, range(20))) == list(range(20))
    sent = len(shared.log.read_text().splitlines())
    assert 1 <= sent <= 2


def test_libraries_have_one_thread_in_each_process() -> None:
    assert set(Processes(2).distribute(work.library_threads, None, range(2))) == {1}
