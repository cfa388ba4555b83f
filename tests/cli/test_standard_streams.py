"""Outputs that cannot be written to cost no file, and the status tells whether a result was lost."""

import errno
import io
import os
import sys
from pathlib import Path

import pytest

from tests.cli.processes import shell
from uvshear.cli.standard_streams import StandardStream, standard_streams

CATALOGUE = "uvshear catalogue --field-arcmin 3 --count 5 -o cat.fits"
LOST = "uvshear: error: standard output: cannot be written"


@pytest.mark.parametrize(
    "closed",
    [
        ">&-",
        "2>&-",
        ">&- 2>&-",
        ">/dev/full",
        "2>/dev/full",
        "&>/dev/full",
        "| true",
        "2>&1 | true",
    ],
)
def test_a_remark_that_cannot_be_shown_costs_nothing(tmp_path: Path, closed: str) -> None:
    done = shell(f"{CATALOGUE} {closed}", tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert os.listdir(tmp_path) == ["cat.fits"]


@pytest.mark.parametrize(
    ("closed", "status", "told"),
    [
        (">&-", 2, f"{LOST} (is closed)\n"),
        (">/dev/full", 2, f"{LOST} (No space left on device)\n"),
        ("2>&- >&-", 2, ""),
        ("| true", 141, ""),
    ],
)
@pytest.mark.parametrize("command", ["layouts", "--help"])
def test_a_result_that_cannot_be_shown_is_a_failure(
    tmp_path: Path, command: str, closed: str, status: int, told: str
) -> None:
    # The shell may be so slow that the reader is still there.
    done = shell(f"{{ sleep 0.3; uvshear {command}; }} {closed}", tmp_path)
    assert (done.returncode, done.stderr) == (status, told)


def test_an_error_that_cannot_be_shown_keeps_its_status(tmp_path: Path) -> None:
    assert shell("uvshear layouts nowhere 2>/dev/full", tmp_path).returncode == 2
    assert shell("uvshear layouts nowhere 2>&-", tmp_path).returncode == 2


def test_a_file_never_gets_the_number_of_a_closed_stream(tmp_path: Path) -> None:
    program = (
        "import os; from uvshear.cli.standard_streams import open_closed_descriptors as f; f();"
        "file = open('out', 'w'); assert file.fileno() > 2; os.write(1, b'of a library')"
    )
    done = shell(f"'{sys.executable}' -c \"{program}\" <&- >&- 2>&-", tmp_path)
    assert done.returncode == 0
    assert (tmp_path / "out").read_text() == ""


@pytest.mark.parametrize(
    ("locale", "shown"),
    [({"PYTHONIOENCODING": "ascii"}, "gr\\xf6\\xdfe.fits"), ({"LC_ALL": "C"}, "größe.fits")],
)
def test_what_the_locale_cannot_show_is_escaped(
    tmp_path: Path, locale: dict[str, str], shown: str
) -> None:
    command = CATALOGUE.replace("cat.fits", "größe.fits")
    done = shell(command, tmp_path, PYTHONUTF8="0", PYTHONCOERCECLOCALE="0", **locale)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{shown}: 5 galaxies\n"
    assert os.listdir(tmp_path) == ["größe.fits"]


def test_the_first_failure_counts() -> None:
    stream = StandardStream(None)
    stream.remark("of no importance")
    assert stream.lost is None
    stream.write("a result")
    assert stream.lost is not None
    assert stream.lost.errno == errno.EBADF


def test_a_stream_that_is_closed_later_is_no_terminal_and_takes_nothing() -> None:
    file = io.StringIO()
    stream = StandardStream(file)
    stream.write("kept")
    file.close()
    stream.write("lost")
    assert stream.lost is not None
    assert not stream.isatty()


def test_streams_are_restored() -> None:
    before = sys.stdout, sys.stderr
    with standard_streams() as output:
        assert sys.stdout is output
    assert (sys.stdout, sys.stderr) == before
