"""Crews of executors that share memory."""

import numpy as np
import pytest

from tests.execution import tasks as work
from tests.execution.tasks import Ledger
from uvshear.execution import SERIAL, Copies, Crew, Processes, Threads
from uvshear.execution.crew import LocalCrew


@pytest.mark.parametrize("executor", [SERIAL, Threads(2), Processes(2)])
def test_a_crew_within_this_process_sees_its_object(executor) -> None:
    ledger = Ledger(np.zeros(1))
    with executor.crew(ledger) as crew:
        assert isinstance(crew, LocalCrew)
        ledger.adopt(3)
        crew.tell(Ledger.adopt, 3)
        assert list(crew.map(work.entry, range(4))) == [(3, 0.0, task) for task in range(4)]


def test_a_crew_of_copies_gives_the_same() -> None:
    ledger = Ledger(np.zeros(1))
    with Copies(2).crew(ledger) as crew:
        assert isinstance(crew, Crew)
        ledger.adopt(3)
        crew.tell(Ledger.adopt, 3)
        assert list(crew.map(work.entry, range(4))) == [(3, 0.0, task) for task in range(4)]
