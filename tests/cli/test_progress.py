"""What commands show of their progress: a bar on a terminal, a line a minute elsewhere."""

import os
import pty
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.processes import COMMAND, environment
from uvshear.cli import progress_lines
from uvshear.cli.progress_text import done_text, left_text, line_about, rate_text
from uvshear.progress import Course, Meter, Stage

LINE = re.compile(
    r"uvshear: (?P<work>[a-z ]+): (?P<stage>[a-z 0-9]+)"
    r"(, \d+ % done)?"
    r"(, (?P<rate>[\d.]+( thousand| million)?) (visibilities|rows|cells|fits|galaxies)/s)?"
    r"(, (a few seconds|about [\d.]+ (s|min|h|days)) left)?"
)


class Clock:
    """A clock that stands still unless it is moved."""

    time = 0.0

    def __call__(self) -> float:
        return self.time


def course_after(seconds: float, done: float, amount: float, unit: str = "fits") -> Course:
    """Return the course of a single stage."""
    clock = Clock()
    course = Course(clock)
    meter = Meter(course)
    meter.begin(Stage("major cycle 3", 1.0, amount, unit))
    for part in (0.5, 1.0):
        clock.time = part * seconds
        meter.add(done / 2)
    return course


def test_a_line_tells_the_stage_its_rate_and_the_time_that_is_left() -> None:
    course = course_after(200.0, 4.1e8, 1e9, "visibilities")
    line = "uvshear: measuring: major cycle 3, 41 % done, 2.05 million visibilities/s, about 5 min left"
    assert line_about("measuring", course) == line
    assert line_about("measuring", Course()) == "uvshear: measuring"


@pytest.mark.parametrize(
    ("left", "text"),
    [
        (0.0, "a few seconds left"),
        (4.9, "a few seconds left"),
        (41.0, "about 40 s left"),
        (88.0, "about 90 s left"),
        (95.0, "about 2 min left"),
        (5300.0, "about 88 min left"),
        (3 * 3600.0, "about 3.0 h left"),
        (3 * 86400.0, "about 3.0 days left"),
    ],
)
def test_the_time_left_is_as_precise_as_it_is_known(left: float, text: str) -> None:
    assert left_text(course_after(100.0, 100.0, 100.0 + left)) == text


@pytest.mark.parametrize(
    ("rate", "text"),
    [
        (0.034, "0.034 fits/s"),
        (4.2, "4.2 fits/s"),
        (123.4, "123 fits/s"),
        (45600.0, "46 thousand fits/s"),
        (2.345e6, "2.35 million fits/s"),
    ],
)
def test_a_rate_has_two_or_three_digits(rate: float, text: str) -> None:
    assert rate_text(course_after(100.0, 100 * rate, 1e9)) == text
    assert rate_text(course_after(100.0, 100 * rate, 1e9, unit="")) == ""


def test_what_is_not_finished_is_not_complete() -> None:
    assert done_text(course_after(100.0, 999.0, 1000.0)) == "99 %"


def test_a_short_run_without_a_terminal_tells_nothing(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", tmp_path / "s.fits")
    assert "uvshear: measuring" not in outcome.err


COMMANDS = {
    "measure": ("measure FIELD --catalogue CAT --keep moments -o s.fits", "measuring"),
    "measure by the paper": (
        "measure FIELD --catalogue CAT --extraction paper -o s.fits",
        "measuring",
    ),
    "average": ("average FIELD --field-arcmin 4 -o a.ms", "averaging"),
    "bias": (
        "bias --estimator moments --galaxies 100 --integration-s 3600 --threads 1 -o b.json",
        "simulating and measuring",
    ),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_long_run_without_a_terminal_tells_a_line_now_and_then(
    uvshear: Callable,
    tmp_path: Path,
    field: Path,
    catalogue: Path,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
) -> None:
    monkeypatch.setattr(progress_lines, "EVERY", 1e-3)
    monkeypatch.chdir(tmp_path)
    words, work = COMMANDS[name]
    places = {"FIELD": str(field), "CAT": str(catalogue)}
    outcome = uvshear(*(places.get(word, word) for word in words.split()))
    assert outcome.status == 0, outcome.err
    lines = [line for line in outcome.err.splitlines() if line.startswith(f"uvshear: {work}")]
    assert lines
    for line in lines:
        found = LINE.fullmatch(line)
        assert found is not None, line
        assert found["work"] == work
    if name == "measure":
        stages = [LINE.fullmatch(line)["stage"] for line in lines]  # type: ignore[index]
        for stage in ("first pass", "major cycle 1", "minor cycle 1", "posteriors", "statistics"):
            assert stage in stages
        assert any("left" in line for line in lines)


def test_no_more_than_a_line_a_minute_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    clock = Clock()
    course = Course(clock)
    lines = progress_lines.ProgressLines("working", course)
    meter = Meter(lines)
    told = []
    for second in range(200):
        clock.time = float(second)
        meter.add()
        if text := capfd.readouterr().err:
            told.append((second, text))
    assert told == [
        (60, "uvshear: working\n"),
        (120, "uvshear: working\n"),
        (180, "uvshear: working\n"),
    ]


def test_a_terminal_shows_a_bar_that_goes_away(
    tmp_path: Path, field: Path, catalogue: Path
) -> None:
    terminal, end = pty.openpty()
    words = ("measure", field, "--catalogue", catalogue, "-o", tmp_path / "s.fits")
    with subprocess.Popen(
        [*COMMAND, *map(str, words)],
        stdin=end,
        stdout=subprocess.DEVNULL,
        stderr=end,
        env=environment(COLUMNS="120", TERM="xterm"),
    ) as running:
        os.close(end)
        shown = b""
        try:
            while piece := os.read(terminal, 4096):
                shown += piece
        except OSError:  # as Linux tells that the other end is closed
            pass
    os.close(terminal)
    text = shown.decode()
    assert running.returncode == 0, text
    assert "measuring: " in text
    assert re.search(r"\d %", text)
    assert "left" in text
    # The last thing is that the line of the bar is erased, and the cursor shown again.
    *_, last = re.split(r"[\r\n]", text.rstrip("\r\n"))
    assert "measuring" not in last
