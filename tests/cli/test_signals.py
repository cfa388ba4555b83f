"""Requests to end: their exit status, what is left of outputs and processes, and what is said."""

import os
import signal
from pathlib import Path

import pytest

from tests.cli.processes import started, wait_for
from uvshear.cli.signals import ENDING, EndRequest, ending_signals

INTERRUPTION = "uvshear: interrupted; unfinished outputs have been removed\n"
OBSERVATION = "--layout meerkat --hours 8 --integration-s 10 --band-mhz 950 1190 --channels 4"


@pytest.mark.parametrize("number", ENDING, ids=lambda number: number.name)
def test_a_request_to_end_leaves_no_part_of_a_measurement_set(
    tmp_path: Path, catalogue: Path, number: signal.Signals
) -> None:
    output = tmp_path / "new" / "field.ms"
    output.parent.mkdir()
    words = f"simulate {OBSERVATION} --declination-deg -30 --snr-at 10 10 --threads 1 --catalogue"
    with started(*words.split(), catalogue, "-o", output) as running:
        wait_for(
            lambda: list(output.parent.rglob("DATA*")) or list(output.parent.rglob("table.dat"))
        )
        running.send_signal(number)
        _, told = running.communicate(timeout=30)
        assert running.returncode == 128 + number
        assert told == INTERRUPTION
        assert os.listdir(output.parent) == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_request_to_end_that_all_processes_get_is_answered_once(
    tmp_path: Path, number: signal.Signals
) -> None:
    output = tmp_path / "bias.json"
    words = "bias --estimator mean --galaxies 100000 --threads 3 -o"
    with started(*words.split(), output) as running:
        wait_for(lambda: len(_workers(running.pid)) >= 2)
        os.killpg(running.pid, number)
        _, told = running.communicate(timeout=30)
        assert running.returncode == 128 + number
        assert told == INTERRUPTION
        wait_for(lambda: not _workers(running.pid), 10)
        assert os.listdir(tmp_path) == []


def test_a_request_to_end_that_another_thread_receives_is_answered(tmp_path: Path) -> None:
    words = "bias --estimator mean --galaxies 100000 --threads 1 -o"
    with started(*words.split(), tmp_path / "bias.json") as running:
        tasks = Path(f"/proc/{running.pid}/task")
        wait_for(lambda: len(list(tasks.iterdir())) >= 2 and _has_read(running.pid, "numba"))
        # The system gives a signal to the thread whose number is used, if this thread takes it.
        os.kill(max(int(task.name) for task in tasks.iterdir()), signal.SIGINT)
        _, told = running.communicate(timeout=30)
        assert running.returncode == 130
        assert told == INTERRUPTION


def _workers(session: int) -> list[str]:
    """Return the living processes of a session that work for its leader."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            is_other = int(process.name) != session
            if is_other and os.getsid(int(process.name)) == session:
                found.append(process.name)
        except OSError:
            continue
    return found


def test_a_signal_that_the_caller_ignores_stays_ignored() -> None:
    told: list[EndRequest] = []
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
    try:
        with ending_signals(told.append):
            os.kill(os.getpid(), signal.SIGHUP)
            os.kill(os.getpid(), signal.SIGTERM)
        assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
    assert [each.status for each in told] == [143]


def test_handlers_are_restored() -> None:
    before = [signal.getsignal(number) for number in ENDING]
    with ending_signals(lambda ending: None):
        assert signal.getsignal(signal.SIGTERM) not in before
    assert [signal.getsignal(number) for number in ENDING] == before


def test_what_is_complete_stays_complete(tmp_path: Path) -> None:
    """An earlier file is there whole after the command that was to replace it has been ended."""
    output = tmp_path / "bias.json"
    output.write_text("{}")
    words = "bias --estimator mean --galaxies 100000 --threads 1 --overwrite -o"
    with started(*words.split(), output) as running:
        wait_for(lambda: _has_read(running.pid, "numba"))
        running.send_signal(signal.SIGTERM)
        running.communicate(timeout=30)
        assert running.returncode == 143
        assert output.read_text() == "{}"
        assert os.listdir(tmp_path) == ["bias.json"]


def _has_read(process: int, library: str) -> bool:
    return library in Path(f"/proc/{process}/maps").read_text()
