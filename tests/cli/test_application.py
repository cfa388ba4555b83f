import re
import subprocess
import sys
import time
from collections.abc import Callable

import pytest
import typer

from uvshear import __version__
from uvshear.cli import application
from uvshear.errors import InputError

COMMANDS = ("layouts", "catalogue", "simulate", "measure", "shear", "psf", "demo")


def test_the_version_is_told(uvshear: Callable) -> None:
    outcome = uvshear("--version")
    assert outcome.status == 0
    assert outcome.out == f"uvshear {__version__}\n"


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(uvshear: Callable, command: str) -> None:
    outcome = uvshear(command, "--help")
    assert outcome.status == 0
    assert re.search(rf"Example: uvshear\s+{command}", outcome.out)


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
        ("shear", "shapes.fits", "--estimator", "guess"),
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
        (KeyboardInterrupt(), 130, "uvshear: interrupted; unfinished outputs are removed\n"),
        (typer.Abort(), 130, "uvshear: interrupted; unfinished outputs are removed\n"),
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


def test_a_real_interrupt_answers_at_once_with_status_130(tmp_path: object) -> None:
    program = (
        "import _thread, threading, uvshear.cli.application as a\n"
        "threading.Timer(1.5, _thread.interrupt_main).start()\n"
        "import sys; sys.exit(a.run(['simulate', '--layout', 'ska-mid-aa4', '--catalogue',"
        " sys.argv[1], '--declination-deg', '-30', '--hours', '8', '--integration-s', '60',"
        " '--band-mhz', '950', '1190', '--snr-at', '10', '10', '-o', sys.argv[2]]))\n"
    )
    catalogue, output = f"{tmp_path}/cat.fits", f"{tmp_path}/field.ms"
    assert application.run(f"catalogue --field-arcmin 9 --count 200 -o {catalogue}".split()) == 0
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", program, catalogue, output],
        capture_output=True,
        check=False,
        text=True,
    )
    assert done.returncode == 130, done.stderr
    assert done.stderr == "uvshear: interrupted; unfinished outputs are removed\n"
    assert time.monotonic() - began < 30
    assert [path.name for path in tmp_path.iterdir()] == ["cat.fits"]  # type: ignore[attr-defined]
