"""An executor of copies."""

import os

import numpy as np
import pytest

from tests.execution import tasks as work
from tests.execution.tasks import Ledger
from uvshear.execution import Copies, Serial, shared_memory


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


def _workers(crew) -> set[int]:
    return {process for *_, process in crew.map(work.seen_by, range(20))}


def test_the_copies_of_a_lasting_executor_serve_one_crew_after_the_other() -> None:
    before = work.children()
    with Copies(3).lasting() as executor:
        seen = set()
        for number in range(4):
            ledger = Ledger(shared_memory.shared_zeros((1,), np.float64))
            with executor.crew(ledger) as crew:
                ledger.memory[0] = number
                ledger.adopt(number)
                crew.tell(Ledger.adopt, number)
                found = list(crew.map(work.seen_by, range(20)))
            assert {entry[:2] for entry in found} == {(number, float(number))}
            seen |= {process for *_, process in found}
        assert len(seen) == 3
        assert len(work.children() - before) == 2
        # Tasks of a call are distributed to the same copies.
        assert set(executor.distribute(work.process, 0, range(20))) <= seen
    assert work.children() == before


def test_what_the_last_crew_was_told_does_not_concern_the_next() -> None:
    with Copies(3).lasting() as executor:
        for number in range(3):
            ledger = Ledger(np.zeros(1))
            with executor.crew(ledger) as crew:
                assert {found for found, *_ in crew.map(work.seen_by, range(20))} == {0}
                crew.tell(Ledger.adopt, number + 1)


def test_a_crew_within_a_crew_has_copies_of_its_own() -> None:
    outer, inner = Ledger(np.zeros(1)), Ledger(np.zeros(1))
    outer.adopt(1)
    inner.adopt(2)
    with Copies(2).lasting() as executor, executor.crew(outer) as first:
        ours = _workers(first)
        with executor.crew(inner) as second:
            others = _workers(second)
            assert {entry[0] for entry in second.map(work.seen_by, range(9))} == {2}
        assert {entry[0] for entry in first.map(work.seen_by, range(9))} == {1}
    assert len(ours) == len(others) == 2
    assert ours & others == {os.getpid()}


class Secret:
    """An object that cannot be pickled."""

    number = 6

    def __reduce__(self):
        raise TypeError("not for others")


def test_what_cannot_be_handed_over_is_known_to_new_copies() -> None:
    with Copies(2).lasting() as executor:
        assert len(set(executor.distribute(work.process, 1, range(20)))) == 2
        found = list(executor.distribute(work.number_of, Secret(), range(20)))
        assert {number for number, _ in found} == {6}
        assert len({process for _, process in found}) == 2


def test_without_a_common_region_every_crew_has_its_copies(monkeypatch) -> None:
    monkeypatch.setattr(shared_memory, "reserve_region", lambda: False)
    executor = Copies(2)
    with executor.lasting() as found:
        assert found is executor


def test_a_lasting_executor_that_is_to_use_less_memory_has_fewer_workers() -> None:
    with Copies(3).lasting() as executor:
        assert executor.at_most(5) is executor
        assert executor.at_most(2) == Copies(2)
        with executor.lasting() as same:
            assert same is executor


def test_other_executors_last_anyway() -> None:
    serial = Serial()
    with serial.lasting() as executor:
        assert executor is serial


@pytest.mark.parametrize("given_up", [False, True])
def test_a_call_that_was_given_up_leaves_nothing_to_the_next_crew(given_up) -> None:
    with Copies(2).lasting() as executor:
        results = executor.distribute(work.brief, None, range(40))
        next(results)
        if given_up:
            results.close()
        else:
            list(results)
        assert list(executor.distribute(work.affine, 3, range(9))) == [3 * k + 1 for k in range(9)]
