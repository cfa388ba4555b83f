"""The command line in processes of its own, with its streams as a shell sets them up."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import uvshear

PACKAGE = Path(uvshear.__file__).parents[1]
COMMAND = [sys.executable, "-m", "uvshear"]


def environment(**more: str) -> dict[str, str]:
    """Environment in which the package is found."""
    return {**os.environ, "PYTHONPATH": str(PACKAGE), "OMP_NUM_THREADS": "1", **more}


def shell(words: str, directory: Path, **more: str) -> subprocess.CompletedProcess[str]:
    """Run a line of a shell, in which ``uvshear`` is the command."""
    command = " ".join(COMMAND)
    return subprocess.run(
        ["bash", "-c", f'set -o pipefail; uvshear() {{ {command} "$@"; }}; {words}'],
        capture_output=True,
        check=False,
        text=True,
        errors="backslashreplace",
        cwd=directory,
        env=environment(**more),
    )


@contextmanager
def started(*words: str | Path) -> Iterator["subprocess.Popen[str]"]:
    """Start a command as the leader of a group of processes, with the signals that a terminal gives it.

    Whatever is left of the group in the end is ended.
    """
    process = subprocess.Popen(
        [*COMMAND, *map(str, words)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env=environment(),
        start_new_session=True,
        # A shell in the background ignores interrupts, as nohup does hangups, and so would their children.
        preexec_fn=_take_all_signals,  # noqa: PLW1509
    )
    try:
        yield process
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def _take_all_signals() -> None:
    for number in (signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def wait_for(condition: Callable[[], object], seconds: float = 60) -> None:
    """Wait until a condition holds."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)
