"""The log of a run: a line in JSON for the run, for each of its stages, and for its end (docs/files.md).

Unlike other outputs a log gets its name at once, and each line is written as soon as it is known, because a log is
needed most after a run that was killed.
"""

import json
import os
import platform
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final, Literal, TextIO

from uvshear.errors import InputError
from uvshear.execution import available_cores
from uvshear.execution.usage import Usage
from uvshear.io.outputs import check_file
from uvshear.io.provenance import Provenance
from uvshear.progress import Observer, Stage

EVERY: Final = 60.0
"""Time between records within a stage [s]."""

SAMPLED_EVERY: Final = 1.0
"""Time between looks at the memory [s]."""


@contextmanager
def run_log(
    path: Path,
    made: Provenance,
    *,
    overwrite: bool,
    appends: bool = False,
    on_failure: Callable[[str], None],
) -> Iterator["RunLog"]:
    """Yield a log that is written until the block ends, in whatever way.

    Parameters
    ----------
    path
        Path of the log.
    made
        Origin of the results of the run.
    overwrite
        Whether a file that exists is replaced.
    appends
        Whether the lines are appended to a log that exists: that of a run that this one continues.
    on_failure
        Function that is called with a line if nothing more can be written; the run goes on.

    Raises
    ------
    InputError
        The log cannot be written.
    """
    check_log(path, overwrite=overwrite, appends=appends)
    mode: Literal["a", "w", "x"] = "w" if overwrite else "x"
    if appends and is_log(path):
        mode = "a"
    try:
        file = path.open(mode, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from error
    log = RunLog(path, file, on_failure)
    try:
        log.write_head(made)
        yield log
    finally:
        # Where the context of a command closes a log, it does not pass the error on.
        log.write_end(sys.exc_info()[1])
        with suppress(OSError):  # of what could not be written
            file.close()


def check_log(path: Path, *, overwrite: bool, appends: bool = False) -> None:
    """Refuse a log that cannot be written, before anything is computed."""
    check_file(path, overwrite=overwrite or (appends and is_log(path)))


def is_log(path: Path) -> bool:
    """Tell whether a file is the log of a run."""
    try:
        with path.open(encoding="utf-8") as file:
            return bool(json.loads(file.readline())["record"] == "run")
    except (OSError, ValueError, KeyError, TypeError):
        return False


class RunLog(Observer):
    """Writes a line for each stage when it ends, in whatever way, and now and then within a long stage.

    Parameters
    ----------
    path
        Path of the log, for messages.
    file
        File that is written to.
    on_failure
        Function that is called with a line if nothing more can be written.
    """

    def __init__(self, path: Path, file: TextIO, on_failure: Callable[[str], None]) -> None:
        self._path, self._file, self._on_failure = path, file, on_failure
        self._has_failed = self._has_ended = False
        self._start = time.monotonic()
        self._stage: Stage | None = None
        self._begun = self._told = self._sampled = self._start
        self._done = self._expected = 0.0
        self._facts: dict[str, object] = {}
        self._before = Usage.now()
        self._memory = self._largest = self._before.memory

    def begin(self, stage: Stage, *then: Stage) -> None:
        """Write a line about the last stage."""
        self._end_stage()
        self._stage, self._facts = stage, {}
        self._done, self._expected = 0.0, stage.amount
        self._begun = self._told = time.monotonic()
        self._before = Usage.now()
        self._memory = self._before.memory

    def advance(self, done: float, expected: float) -> None:
        """Look at the memory, and write a line if the last one is long ago."""
        self._done, self._expected = done, expected
        now = time.monotonic()
        if now < self._sampled + SAMPLED_EVERY:
            return
        usage = Usage.now()
        self._sampled = now
        self._memory = max(self._memory, usage.memory)
        if now >= self._told + EVERY:
            self._told = now
            name = self._stage.name if self._stage else ""
            at = {"stage": name, "seconds": self._since_start(now), **self._share}
            self._write("progress", {**at, "memory_bytes": round(usage.memory)})

    def foresee(self, *then: Stage) -> None:
        """Do nothing: stages are written down when they end."""

    def note(self, facts: Mapping[str, object]) -> None:
        """Keep facts for the line about the stage."""
        self._facts.update(facts)

    def finish(self) -> None:
        """Write a line about the last stage."""
        self._end_stage()
        self._stage = None

    def write_head(self, made: Provenance) -> None:
        """Write the line about the run."""
        _OPEN.append(self)
        pages = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        machine = {
            "cores": available_cores(),
            "machine_memory_bytes": pages,
            "system": platform.platform(),
            "python": platform.python_version(),
            "process": os.getpid(),
        }
        self._write("run", {**made.record(), **machine})

    def write_end(self, error: BaseException | None) -> None:
        """Write the line about the end of the run, and about the error that has ended it."""
        if self._has_ended:
            return
        self._has_ended = True
        if self in _OPEN:
            _OPEN.remove(self)
        outcome = {"outcome": "finished"}
        if isinstance(error, KeyboardInterrupt):
            outcome = {"outcome": "interrupted"}
        elif error is not None:
            message = " ".join(f"{type(error).__name__}: {error}".split())
            outcome = {"outcome": "failed", "message": message}
        # Work that does not tell of its end has ended with a run that nothing has ended before.
        self._end_stage(is_cut_short=error is not None)
        self._stage = None
        usage = Usage.now()
        self._write(
            "end",
            {
                **outcome,
                "seconds": self._since_start(time.monotonic()),
                "cpu_seconds": round(usage.cpu_seconds, 2),
                "peak_memory_bytes": round(max(self._largest, usage.memory, usage.peak)),
            },
        )

    def _end_stage(self, *, is_cut_short: bool = False) -> None:
        if (stage := self._stage) is None:
            return
        now, usage = time.monotonic(), Usage.now()
        memory = max(self._memory, usage.memory)
        if usage.peak > self._before.peak:
            memory = max(memory, usage.peak)
        self._largest = max(self._largest, memory)
        seconds = now - self._begun
        work: dict[str, object] = {}
        if stage.unit and self._done > 0:
            rate = self._done / seconds if seconds > 0 else None
            work = {"done": round(self._done), "unit": stage.unit, "per_second": _short(rate)}
        if is_cut_short:
            work |= {"finished": False, **self._share}
        self._write(
            "stage",
            {
                "stage": stage.name,
                "start": round(self._begun - self._start, 3),
                "seconds": round(seconds, 3),
                "cpu_seconds": round(usage.cpu_seconds - self._before.cpu_seconds, 2),
                "peak_memory_bytes": round(memory),
                **work,
                **self._facts,
            },
        )

    @property
    def _share(self) -> dict[str, float]:
        """The part of the stage that is done, if it is known."""
        return {"share": round(self._done / self._expected, 3)} if self._expected > 0 else {}

    def _since_start(self, now: float) -> float:
        return round(now - self._start, 3)

    def _write(self, kind: str, values: Mapping[str, Any]) -> None:
        if self._has_failed:
            return
        try:
            self._file.write(json.dumps({"record": kind, **values}) + "\n")
            self._file.flush()
        except OSError as error:
            self._has_failed = True
            reason = f"{self._path}: cannot be written any more ({error.strerror})"
            self._on_failure(f"{reason}; the run goes on without a log")


_OPEN: Final[list[RunLog]] = []
"""Logs of runs that have not ended."""


def end_open_logs() -> None:
    """Write that the runs were interrupted, because the process ends without waiting for them."""
    for log in tuple(_OPEN):
        log.write_end(KeyboardInterrupt())


def _short(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.4g}")
