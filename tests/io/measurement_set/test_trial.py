"""The trial of a Measurement Set in a process of its own."""

import ctypes
import os
import signal
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import pytest

from tests.execution.tasks import children
from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.measurement_set import trial
from uvshear.io.measurement_set.reader import MeasurementSetReader
from uvshear.io.measurement_set.trial import check_by_trial
from uvshear.io.reading import Reading
from uvshear.io.unfinished import unfinished_directory


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return written(tmp_path)


def _overrun() -> None:
    ctypes.string_at(0)


def _aborted() -> None:
    os.abort()


@pytest.mark.parametrize(("read", "name"), [(_overrun, "SIGSEGV"), (_aborted, "SIGABRT")])
def test_a_set_that_ends_the_process_is_refused(
    path: Path, capfd: pytest.CaptureFixture[str], read: Callable[[], None], name: str
) -> None:
    message = rf"field\.ms: is damaged; casacore ended the process \({name}\) when it read the set"
    with pytest.raises(InputError, match=message):
        check_by_trial(path, read)
    assert capfd.readouterr() == ("", "")


def test_an_error_is_left_to_those_who_read(path: Path) -> None:
    def read() -> None:
        raise RuntimeError

    check_by_trial(path, read)


def test_a_set_from_which_nothing_returns_is_refused(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trial, "LONGEST", 0.2)
    with pytest.raises(
        InputError, match=r"casacore did not return within 0 s when it read the set"
    ):
        check_by_trial(path, lambda: time.sleep(60))


def test_a_signal_ends_the_trial(path: Path) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before, before_the_trial = signal.signal(signal.SIGALRM, interrupt), children()
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        begun = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            check_by_trial(path, lambda: time.sleep(60))
        assert time.monotonic() - begun < 10
    finally:
        signal.signal(signal.SIGALRM, before)
    assert children() == before_the_trial


def test_the_trial_removes_nothing(path: Path, tmp_path: Path) -> None:
    """The end by a C++ library removes unfinished files, but those of the trial are another process's."""
    terminate = ctypes.CDLL("libstdc++.so.6")["_ZSt9terminatev"]
    with unfinished_directory(tmp_path / "shapes.fits") as kept:
        (kept / "shapes.fits").write_text("half")
        with pytest.raises(InputError, match="SIGABRT"):
            check_by_trial(path, terminate)
        assert (kept / "shapes.fits").read_text() == "half"


def test_files_of_others_are_not_tried(tmp_path: Path) -> None:
    check_by_trial(tmp_path / "absent.ms", _aborted)
    check_by_trial(tmp_path, _aborted)


def test_every_command_tries_a_set_first(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def wait_for(ms: Path, read: Callable[[], object]) -> AbstractContextManager:
        return nullcontext(lambda: tried.append((ms, read)))

    monkeypatch.setattr(
        "uvshear.io.measurement_set.reader.check_by_trial", lambda *args: tried.append(args)
    )
    monkeypatch.setattr("uvshear.io.measurement_set.reader.trial", wait_for)
    reader = MeasurementSetReader()
    reader.open(path, Reading())
    reader.inspect(path, Reading())
    assert [ms for ms, _ in tried] == [path, path]
    for _, read in tried:
        read()
