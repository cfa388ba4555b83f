"""Copies of this process that work for it."""

import os
import resource
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor
from pathlib import Path

import numpy as np
import pytest

from tests.execution import tasks as work
from tests.execution.tasks import Ledger
from uvshear.execution import copied_crew
from uvshear.execution.copied_crew import AHEAD, CopiedCrew, end_copies
from uvshear.execution.shared_memory import shared_zeros

pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="processes are copied on Linux only"
)


def test_this_process_and_its_copies_work() -> None:
    before = work.children()
    with CopiedCrew(None, 3) as crew:
        list(crew.map(work.brief, range(2)))
        seen = {process for _, process in crew.map(work.brief, range(40))}
        assert len(work.children() - before) == 2
    assert os.getpid() in seen
    assert len(seen) == 3


def test_copies_get_further_tasks_while_this_process_is_busy() -> None:
    with CopiedCrew(os.getpid(), 2) as crew:
        seen = list(crew.map(work.long_in, range(30)))
    assert seen.count(os.getpid()) <= 2


def test_one_worker_needs_no_copies() -> None:
    before = work.children()
    with CopiedCrew(None, 1) as crew:
        assert set(crew.map(work.process, range(9))) == {os.getpid()}
        assert work.children() == before


def test_copies_are_made_only_for_work_that_is_worth_them(monkeypatch) -> None:
    monkeypatch.setattr(copied_crew, "WORTH_COPIES", 60.0)
    before = work.children()
    with CopiedCrew(None, 2) as crew:
        list(crew.map(work.process, range(1)))
        assert set(crew.map(work.process, range(9))) == {os.getpid()}
        assert work.children() == before
        monkeypatch.setattr(copied_crew, "WORTH_COPIES", 0.0)
        assert len(set(crew.map(work.process, range(9)))) == 2
        # Copies that have been made are used.
        monkeypatch.setattr(copied_crew, "WORTH_COPIES", 60.0)
        assert len(set(crew.map(work.process, range(9)))) == 2


def test_copies_go_on_where_this_process_has_begun(monkeypatch) -> None:
    monkeypatch.setattr(copied_crew, "WORTH_COPIES", 0.05)
    with CopiedCrew(None, 2) as crew:
        list(crew.map(work.brief, range(1)))
        numbers, processes = zip(*crew.map(work.brief, (task for task in range(30))), strict=True)
        assert list(numbers) == list(range(30))
        assert processes[0] == os.getpid()
        assert len(set(processes[6:])) == 2
        # The work of one call counts for the next one.
        assert len({process for _, process in crew.map(work.brief, range(4))}) == 2


def test_copies_are_made_at_once_where_much_work_is_foreseen(monkeypatch) -> None:
    monkeypatch.setattr(copied_crew, "WORTH_COPIES", 0.2)
    with CopiedCrew(None, 2) as crew:
        list(crew.map(work.brief, range(1)))
        assert len({process for _, process in crew.map(work.brief, range(5))}) == 1
        seen = [process for _, process in crew.map(work.brief, range(30))]
        assert len(set(seen[:6])) == 2


def test_a_function_that_was_never_called_may_take_long(monkeypatch) -> None:
    monkeypatch.setattr(copied_crew, "WORTH_COPIES", 60.0)
    monkeypatch.delitem(copied_crew._last_duration, work.brief, raising=False)
    with CopiedCrew(None, 2) as crew:
        assert len({process for _, process in crew.map(work.brief, range(4))}) == 2
    with CopiedCrew(None, 2) as crew:
        assert len({process for _, process in crew.map(work.brief, range(4))}) == 1


def test_long_tasks_wait_for_none_and_the_last_task_needs_no_copies(monkeypatch) -> None:
    monkeypatch.setattr(copied_crew, "WORTH_COPIES", 0.005)
    before = work.children()
    with CopiedCrew(None, 2) as crew:
        monkeypatch.delitem(copied_crew._last_duration, work.brief, raising=False)
        assert [process for _, process in crew.map(work.brief, range(1))] == [os.getpid()]
        assert work.children() == before
    # By now the function is known to take longer than copies do.
    with CopiedCrew(None, 2) as crew:
        assert len({process for _, process in crew.map(work.brief, range(4))}) == 2


def test_small_tasks_come_together_and_long_ones_alone() -> None:
    worth, most = copied_crew.WORTH_A_MESSAGE, copied_crew.MOST_IN_A_BATCH
    assert copied_crew._batch_size(worth / 100, 1000, 2) == most
    assert copied_crew._batch_size(worth / 3.5, 1000, 2) == 3
    assert copied_crew._batch_size(worth / 100, 12, 2) == 3
    assert copied_crew._batch_size(worth / 100, 1, 2) == 1
    assert copied_crew._batch_size(2 * worth, 1000, 2) == 1
    # Nothing is known of the first tasks.
    assert copied_crew._batch_size(float("inf"), 1000, 2) == 1


def test_results_keep_their_order_though_the_first_task_ends_last() -> None:
    with CopiedCrew(None, 3) as crew:
        assert list(crew.map(work.slow_first, range(9))) == list(range(9))
        assert list(crew.map(work.slow_first, [])) == []


def test_tasks_are_taken_as_they_are_begun() -> None:
    taken = []

    def tasks():
        for task in range(50):
            taken.append(task)
            yield task

    with CopiedCrew(None, 2) as crew:
        results = crew.map(work.nothing, tasks())
        assert [next(results) for _ in range(3)] == [0, 1, 2]
        assert len(taken) <= 3 + 2 * AHEAD


def test_copies_see_shared_memory_and_what_they_are_told() -> None:
    memory, own = shared_zeros((1,), np.float64), np.zeros(1)
    ledger, stale = Ledger(memory), Ledger(own)
    with CopiedCrew(ledger, 2) as crew, CopiedCrew(stale, 2) as other:
        for one in (crew, other):
            list(one.map(work.seen_by, range(3)))
        memory[0] = own[0] = 7.0
        ledger.adopt(5)
        crew.tell(Ledger.adopt, 5)
        seen = list(crew.map(work.seen_by, range(9)))
        assert {entry[:2] for entry in seen} == {(5, 7.0)}
        assert len({process for *_, process in seen}) == 2
        # Memory that is not shared is in a copy as it was when the copy was made.
        seen = list(other.map(work.seen_by, range(9)))
        assert {entry[:2] for entry in seen if entry[2] != os.getpid()} == {(0, 0.0)}


def test_updates_reach_a_copy_before_its_next_task_in_their_order() -> None:
    ledger = Ledger(np.zeros(1))
    with CopiedCrew(ledger, 3) as crew:
        list(crew.map(work.seen_by, range(3)))
        for number in (4, 9, 8):
            ledger.adopt(number)
            crew.tell(Ledger.adopt, number)
        seen = list(crew.map(work.seen_by, range(30)))
        assert {number for number, *_ in seen} == {8}
        assert len({process for *_, process in seen}) == 3


def test_after_a_call_that_was_given_up_new_copies_work() -> None:
    before = work.children()
    with CopiedCrew(None, 2) as crew:
        for _ in crew.map(work.brief, range(30)):
            break
        # The copy answers what it was still sent.
        time.sleep(0.1)
        assert [task for task, _ in crew.map(work.brief, range(30, 60))] == list(range(30, 60))
        assert len(work.children() - before) == 1
    assert work.children() == before


def test_descriptors_above_1023_are_possible() -> None:
    most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(most[0], 1200), most[1]))
    try:
        held = [os.open(os.devnull, os.O_RDONLY) for _ in range(1050)]
        try:
            with CopiedCrew(None, 2) as crew:
                assert list(crew.map(work.nothing, range(9))) == list(range(9))
        finally:
            for descriptor in held:
                os.close(descriptor)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, most)


def test_large_results_arrive() -> None:
    with CopiedCrew(None, 2) as crew:
        for task, found in enumerate(crew.map(work.large, range(6))):
            np.testing.assert_array_equal(found, task)


def test_an_error_of_a_task_is_raised_here() -> None:
    before = work.children()
    with CopiedCrew(None, 2) as crew, pytest.raises(ValueError, match="task 3"):
        list(crew.map(work.failing, range(20)))
    assert work.children() == before


def test_a_copy_that_ends_is_an_error() -> None:
    before = work.children()
    with CopiedCrew(os.getpid(), 2) as crew, pytest.raises(BrokenExecutor, match="ended before"):
        list(crew.map(work.ended, range(20)))
    assert work.children() == before


def test_copies_end_with_the_block_and_on_demand() -> None:
    before = work.children()
    with CopiedCrew(None, 2) as crew:
        list(crew.map(work.process, range(9)))
        assert len(work.children() - before) == 1
    assert work.children() == before
    with CopiedCrew(None, 2) as crew:
        list(crew.map(work.process, range(9)))
        end_copies()
        assert work.children() == before


KILLED = """
import os, signal
from tests.execution import tasks as work
from uvshear.execution.copied_crew import CopiedCrew
crew = CopiedCrew(None, 2)
print(*crew.map(work.process, range(5)), flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_copies_end_with_a_process_that_is_killed() -> None:
    root = Path(__file__).parents[2]
    ended = subprocess.run(
        [sys.executable, "-c", KILLED], capture_output=True, text=True, check=False, cwd=root
    )
    assert ended.returncode == -signal.SIGKILL
    deadline = time.monotonic() + 10
    for pid in {int(word) for word in ended.stdout.split()[1:]}:
        while time.monotonic() < deadline and Path(f"/proc/{pid}").exists():
            state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
            if state == "Z":
                break
            time.sleep(0.01)
        else:
            assert not Path(f"/proc/{pid}").exists()
