"""Progress bars and remarks, which never end a run, whatever the terminal."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.processes import environment
from uvshear.cli.progress_report import progress_report
from uvshear.cli.terminal import remarks

PROGRAM = """
import sys, time
from pathlib import Path
from uvshear.cli.standard_streams import standard_streams
from uvshear.cli.progress_report import progress_report
from uvshear.cli.terminal import say, warn
with standard_streams():
    with progress_report("working") as progress:
        for done in range(20):
            progress(done, 20)
            time.sleep(0.03)
            warn("gr\\u00f6\\u00dfer")
    say("done")
Path(sys.argv[1]).write_text("written")
"""


@pytest.mark.parametrize(
    "odd",
    [
        {"TERM": "dumb"},
        {"TERM": "unknown"},
        {"TERM": ""},
        {"COLUMNS": "1", "LINES": "1"},
        {"COLUMNS": "0", "LINES": "0"},
        {"COLUMNS": "many"},
        {"PYTHONIOENCODING": "ascii"},
        {"NO_COLOR": "1"},
    ],
    ids=str,
)
def test_no_terminal_is_too_odd(tmp_path: Path, odd: dict[str, str]) -> None:
    running, terminal = _on_a_terminal(tmp_path / "file", odd)
    shown = _all_of(terminal)
    assert running.wait(timeout=30) == 0, shown
    assert "done" in shown
    assert "Traceback" not in shown
    assert (tmp_path / "file").read_text() == "written"


def test_a_terminal_that_goes_away_costs_nothing(tmp_path: Path) -> None:
    running, terminal = _on_a_terminal(tmp_path / "file", {})
    os.read(terminal, 10)
    os.close(terminal)
    assert running.wait(timeout=30) == 0
    assert (tmp_path / "file").read_text() == "written"


def _on_a_terminal(file: Path, odd: dict[str, str]) -> tuple["subprocess.Popen[bytes]", int]:
    """Start the program on a terminal; return it and the terminal's other end."""
    terminal, end = pty.openpty()
    running = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, file],
        stdin=end,
        stdout=end,
        stderr=end,
        env=environment(**odd),
    )
    os.close(end)
    return running, terminal


def _all_of(terminal: int) -> str:
    shown = b""
    try:
        while piece := os.read(terminal, 4096):
            shown += piece
    except OSError:  # as Linux tells that the other end is closed
        pass
    os.close(terminal)
    return shown.decode(errors="replace")


@pytest.mark.parametrize("name", ["FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE"])
def test_no_bar_is_drawn_where_there_is_no_terminal(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], name: str
) -> None:
    monkeypatch.setenv(name, "1")
    with progress_report("working") as progress:
        progress(1, 2)
    assert capfd.readouterr() == ("", "")


def test_a_remark_that_fails_is_a_note(capfd: pytest.CaptureFixture[str]) -> None:
    with remarks():
        raise KeyError("tolerance")
    note = "uvshear: note: a remark cannot be shown (KeyError: 'tolerance')\n"
    assert capfd.readouterr().err == note
