import importlib
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer

from uvshear import __version__
from uvshear.cli import application
from uvshear.errors import InputError

COMMANDS = tuple(typer.main.get_command(application.app).commands)
GROUPED = ("simulate", "info", "average", "measure", "shear", "bias", "psf", "reproduce")
GROUPS = [
    *("Arguments", "Data", "Simulated sky", "Array and track", "Noise"),
    *("Model", "Method", "Output", "Resources", "Options"),
]


def test_the_version_is_told(uvshear: Callable) -> None:
    outcome = uvshear("--version")
    assert outcome.status == 0
    assert outcome.out == f"uvshear {__version__}\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(uvshear: Callable, command: str) -> None:
    outcome = uvshear(command, "--help")
    assert outcome.status == 0
    assert re.search(rf"Example: uvshear\s+{command}", outcome.out)


@pytest.mark.parametrize("command", GROUPED)
def test_options_are_grouped_in_one_order(uvshear: Callable, command: str) -> None:
    told = uvshear(command, "--help").out
    groups = re.findall(r"^(\w[\w ]+):$", told, re.M)
    assert len(groups) > 2
    assert groups == [group for group in GROUPS if group in groups]


@pytest.mark.parametrize("columns", [80, 100])
def test_the_list_of_commands_is_not_cut(
    uvshear: Callable, monkeypatch: pytest.MonkeyPatch, columns: int
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    told = uvshear("--help").out
    lines = told[told.index("Commands:") :].splitlines()[1 : len(COMMANDS) + 1]
    assert [line.split()[0] for line in lines] == list(COMMANDS)
    assert all(line.endswith(".") and not line.endswith("...") for line in lines)


@pytest.mark.parametrize("columns", [80, 100])
@pytest.mark.parametrize("command", COMMANDS)
def test_help_fits_the_terminal(
    uvshear: Callable, monkeypatch: pytest.MonkeyPatch, command: str, columns: int
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    assert max(map(len, uvshear(command, "--help").out.splitlines())) <= columns


@pytest.mark.parametrize("command", COMMANDS)
def test_no_help_begins_in_the_middle_of_a_sentence(command: str) -> None:
    known = typer.main.get_command(application.app).commands[command]
    texts = [known.help, known.short_help, *(part.help for part in known.params)]
    assert all(text for text in texts)
    assert [text for text in texts if re.match(r"(Of|How|By)\b", text)] == []


def test_the_package_runs_as_a_module() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "uvshear", "layouts", "alma"],
        capture_output=True,
        check=False,
        text=True,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("uvshear: error: layout alma: neither a known array")


def test_help_does_not_wait_for_heavy_imports() -> None:
    check = (
        "import sys, uvshear.cli.application as a\n"
        "assert a.run(['measure', '--help']) == 0\n"
        "heavy = {'numba', 'astropy', 'matplotlib', 'scipy', 'casacore', 'ducc0', 'numpy'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
    )
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", check], capture_output=True, check=False, text=True
    )
    assert done.returncode == 0, done.stderr
    assert time.monotonic() - began < 5  # 0.2 s on a quiet machine


@pytest.mark.parametrize(
    "words",
    [
        ("nonsense",),
        ("catalogue",),
        ("catalogue", "--desnity", "3"),
        ("catalogue", "--field-arcmin", "wide", "--density", "2", "-o", "cat.fits"),
        ("measure", "--facet", "round", "field.ms", "--catalogue", "cat.fits", "-o", "s.fits"),
        ("layouts", "ska-mid-aa4", "surplus"),
    ],
)
def test_a_wrong_call_is_one_line_with_status_2(uvshear: Callable, words: tuple[str, ...]) -> None:
    outcome = uvshear(*words)
    assert outcome.status == 2
    assert outcome.out == ""
    assert outcome.err.startswith("uvshear: error: ")
    assert outcome.err.count("\n") == 1
    assert "--help" in outcome.err


def _failing(error: BaseException) -> Callable[..., int]:
    def fail(**_: object) -> int:
        raise error

    return fail


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        (InputError("cat.fits: is\nwrong"), 2, "uvshear: error: cat.fits: is wrong\n"),
        (KeyboardInterrupt(), 130, "uvshear: interrupted; unfinished outputs have been removed\n"),
        (typer.Abort(), 130, "uvshear: interrupted; unfinished outputs have been removed\n"),
        (
            OSError(28, "No space left on device", "out.fits"),
            2,
            "uvshear: error: out.fits: No space left on device\n",
        ),
    ],
)
def test_what_stops_a_command_is_one_line(
    uvshear: Callable,
    monkeypatch: pytest.MonkeyPatch,
    error: BaseException,
    status: int,
    line: str,
) -> None:
    monkeypatch.setattr(application, "app", _failing(error))
    outcome = uvshear("measure")
    assert outcome.status == status
    assert outcome.err == line


def test_a_bug_keeps_its_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(application, "app", _failing(ZeroDivisionError()))
    with pytest.raises(ZeroDivisionError):
        application.run([])


SIMULATION = (
    "simulate --layout ska-mid-aa4 --declination-deg -30 --hours 8 --integration-s 60 "
    "--band-mhz 950 1190 --snr-at 10 10"
)
"""9.3 million rows and 200 galaxies: ten seconds or more."""


def test_a_real_interrupt_answers_at_once_with_status_130(tmp_path: Path) -> None:
    program = (
        "import os, signal, sys, threading\n"
        "from uvshear.cli import main\n"
        # a shell in the background ignores interrupts, and so would its children
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "threading.Timer(2, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        "main(sys.argv[1:])\n"
    )
    catalogue = tmp_path / "cat.fits"
    words = f"catalogue --field-arcmin 9 --count 200 -o {catalogue}"
    assert application.run(words.split()) == 0
    files = ["--catalogue", str(catalogue), "-o", str(tmp_path / "field.ms")]
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", program, *SIMULATION.split(), *files],
        capture_output=True,
        check=False,
        text=True,
    )
    assert done.returncode == 130, done.stderr
    assert done.stderr == "uvshear: interrupted; unfinished outputs have been removed\n"
    assert time.monotonic() - began < 10  # 4 on a quiet machine, imports and the timer's 2 included
    assert not (tmp_path / "field.ms").exists()


def test_main_exits_with_the_status_of_the_command(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        application.main(["--version"])
    assert ended.value.code == 0
    with pytest.raises(SystemExit) as ended:
        application.main(["layouts", "alma"])
    assert ended.value.code == 2
    assert capfd.readouterr().err.count("\n") == 1


def test_a_thread_that_imports_is_known(tmp_path, monkeypatch):
    """What is half imported when a signal comes would not survive an interruption."""
    (tmp_path / "slow_to_import.py").write_text(
        "import gate_of_the_test as gate\ngate.begun.set()\ngate.may_end.wait(10)\n"
    )
    gate = SimpleNamespace(begun=threading.Event(), may_end=threading.Event())
    monkeypatch.setitem(sys.modules, "gate_of_the_test", gate)
    monkeypatch.syspath_prepend(str(tmp_path))
    importing = threading.Thread(target=importlib.import_module, args=("slow_to_import",))
    importing.start()
    assert gate.begun.wait(10)
    assert application._is_importing(importing)
    gate.may_end.set()
    importing.join(10)
    assert not application._is_importing(importing)
    assert not application._is_importing(threading.current_thread())
