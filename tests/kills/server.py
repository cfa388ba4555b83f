"""Runs commands in forked processes, which need no imports, and kills them at a time or at an event of their files."""

import contextlib
import os
import random
import shutil
import signal
import sys
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import uvshear.cli.application  # what the forked processes need is imported here
import uvshear.pipeline.measure
import uvshear.pipeline.shear
import uvshear.plot
from tests.kills.commands import COMMANDS, INPUTS, Command
from tests.kills.fingerprints import fingerprint, run_of
from uvshear.errors import InputError
from uvshear.io.unfinished import MARK
from uvshear.pipeline.measurement import read_measurement

EVENTS = ("open", "os.", "shutil.", "tempfile.", "ctypes.")
"""Beginnings of the names of audit events at which a process may be killed."""

MOST_ATTEMPTS = 2
"""Number of times that a command is run for each kill, at most: some runs end before their kill."""

KILLS_OF_A_DEMO = 10
"""Number of times that one demo is killed before it may come to its end."""

NEVER = 10**9
"""Number of an event that does not come."""


@dataclass(frozen=True)
class Ended:
    """How a process ended: its status, None if it was killed, and the seconds that it took."""

    status: int | None
    seconds: float


def run(words: Sequence[str], *, after: float | None = None, at_event: int | None = None) -> Ended:
    """Run a command in a forked process.

    Parameters
    ----------
    words
        Command line.
    after
        Seconds after which the process is killed.
    at_event
        Number of the event of files in the working directory at which the process kills itself.
    """
    begin = time.monotonic()
    child = os.fork()
    if child == 0:
        _become(words, at_event)
    if after is not None:
        time.sleep(after)
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    ended = os.waitstatus_to_exitcode(status)
    return Ended(None if ended == -signal.SIGKILL else ended, time.monotonic() - begin)


def _become(words: Sequence[str], at_event: int | None) -> None:
    status = 70
    try:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        log = os.open("log", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(log, 2)
        if at_event is not None:
            sys.addaudithook(_killer(at_event))
        status = uvshear.cli.application.run(list(words))
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(status)


def _killer(at_event: int) -> Any:
    seen = 0
    count = Path("events").open("wb", buffering=0)  # noqa: SIM115 - until the process ends
    here = os.getcwd()

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal seen
        if event.startswith(EVENTS) and any(
            isinstance(each, str | bytes | os.PathLike) and _is_here(each, here)
            for each in arguments
        ):
            seen += 1
            if at_event == NEVER:
                count.write(f"{seen}\n".encode())
                count.seek(0)
            elif seen == at_event:
                os.kill(os.getpid(), signal.SIGKILL)

    return hook


def _is_here(path: Any, here: str) -> bool:
    text = os.fsdecode(path)
    return not text.startswith(("/dev", "/proc")) and (
        text.startswith(here) or not text.startswith("/")
    )


def events_of(words: Sequence[str]) -> int:
    """Count the events of files of a command."""
    assert run(words, at_event=NEVER).status == 0, Path("log").read_text()
    return int(Path("events").read_text())


class Battery:
    """Kills one command again and again in the working directory.

    Parameters
    ----------
    command
        The command.
    seed
        Seed of the moments.
    """

    def __init__(self, command: Command, seed: int) -> None:
        self.command = command
        self.words = command.words.split()
        self.random = random.Random(seed)
        self.outputs = command.in_directory(Path())
        first = run([*self.words, "--overwrite"])
        assert first.status == 0, Path("log").read_text()
        second = run([*self.words, "--overwrite"])
        self.seconds = second.seconds
        self.clean = [fingerprint(path) for path in self.outputs]
        self.events = events_of([*self.words, "--overwrite"])
        self.killed = 0

    def kill(self, *, replaces: bool, at_event: bool) -> None:
        """Kill the command once, with or without outputs that are there before; check what it leaves."""
        self.remove()
        if replaces:
            assert run(self.words).status == 0, Path("log").read_text()
        words = [*self.words, "--overwrite"] if replaces else self.words
        if at_event:
            ended = run(words, at_event=self.random.randint(1, self.events))
        else:
            ended = run(words, after=self.random.uniform(0, 1.1 * self.seconds))
        self.killed += ended.status is None
        there = [path.exists() for path in self.outputs]
        assert not replaces or all(there), "an old output is gone"
        self._check_whole()
        # The last output of a set appears last.
        again = (
            self.words if not there[-1] and self._may_begin_anew() else [*self.words, "--overwrite"]
        )
        following = run(again)
        assert following.status == 0, Path("log").read_text()[-500:]
        # The machine may be busier now, or less busy.
        self.seconds = following.seconds
        assert [fingerprint(path) for path in self.outputs] == self.clean
        hidden = [path.name for path in Path().iterdir() if MARK in path.name]
        assert not hidden, hidden

    def remove(self) -> None:
        """Remove the outputs."""
        for path in self.outputs:
            if path.is_dir():
                for inner in sorted(path.rglob("*"), reverse=True):
                    inner.rmdir() if inner.is_dir() else inner.unlink()
                path.rmdir()
            else:
                path.unlink(missing_ok=True)

    def _may_begin_anew(self) -> bool:
        """Tell whether the next run needs no --overwrite: nothing that was made has its final name."""
        return self.command.is_one_set or not any(path.exists() for path in self.outputs)

    def _check_whole(self) -> None:
        found = [
            fingerprint(path) if path.exists() else expected
            for path, expected in zip(self.outputs, self.clean, strict=True)
        ]
        assert found == self.clean, "an output is not whole"
        shapes = self.outputs[-1]
        if self.command.is_one_set and shapes.exists():
            runs = {run_of(path) for path in self.outputs if path.exists()}
            try:
                read_measurement(shapes)
            except InputError:
                assert len(runs) > 1, "files of one measurement are refused"
            else:
                assert len(runs) == 1, "files of two measurements are mixed"
                assert all(path.exists() for path in self.outputs), "a file is missing"


def main(name: str, kills: int, seed: int) -> None:
    """Kill a command, in an empty working directory that has array.txt; half of the times where outputs exist."""
    for line in INPUTS:
        assert run(line.split()).status == 0, Path("log").read_text()
    battery = Battery(COMMANDS[name], seed)
    for number in range(MOST_ATTEMPTS * kills):
        if battery.killed == kills:
            break
        try:
            battery.kill(replaces=number % 2 == 1, at_event=number % 4 < 2)
        except AssertionError as error:
            raise AssertionError(f"kill {number} of {name} with seed {seed}: {error}") from error
    print(f"{battery.killed} {battery.events}")  # noqa: T201 - for the test that started this process


def kill_demo(kills: int, seed: int) -> None:
    """Kill the demo, each time on what the last one has left; let every tenth one come to its end."""
    words, moments = ["demo", "demo", "--threads", "1"], random.Random(seed)
    first = run(words)
    assert first.status == 0, Path("log").read_text()[-500:]
    clean = _fingerprints(Path("demo"))
    events = events_of([*words, "--overwrite"])
    killed, has_ended = 0, True
    for number in range(MOST_ATTEMPTS * kills):
        if number % KILLS_OF_A_DEMO == 0 or has_ended:
            shutil.rmtree("demo")
        if number % 2:
            ended = run(words, at_event=moments.randint(1, events))
        else:
            ended = run(words, after=moments.uniform(0, 1.1 * first.seconds))
        killed += ended.status is None
        assert ended.status in {None, 0}, Path("log").read_text()[-500:]
        left = _fingerprints(Path("demo")) if Path("demo").exists() else {}
        assert left.items() <= clean.items(), "a file is not whole"
        has_ended = left == clean
        if (number + 1) % KILLS_OF_A_DEMO == 0 or killed == kills:
            _end_demo([*words, "--overwrite"] if has_ended else words, clean)
        if killed == kills:
            break
    print(f"{killed} {events}")  # noqa: T201 - for the test that started this process


def _fingerprints(directory: Path) -> dict[str, str]:
    """Return the hashes of all files that are not hidden."""
    return {
        path.name: fingerprint(path)
        for path in directory.iterdir()
        if not path.name.startswith(".")
    }


def _end_demo(words: Sequence[str], clean: dict[str, str]) -> None:
    """Let the demo come to its end; its files are then those of a demo that nothing disturbed."""
    last = run(words)
    assert last.status == 0, Path("log").read_text()[-500:]
    assert _fingerprints(Path("demo")) == clean
    hidden = [path.name for path in Path("demo").iterdir() if path.name.startswith(".")]
    assert not hidden, hidden


if __name__ == "__main__":
    if sys.argv[1] == "demo":
        kill_demo(int(sys.argv[2]), int(sys.argv[3]))
    else:
        main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
