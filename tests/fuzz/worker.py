"""Runs mutated inputs through the command line, in a process of its own that may crash, hang or use up memory."""

import os
import resource
import shutil
import sys
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from tests.fuzz.case import Case, Kind, Reading
from tests.fuzz.clean_inputs import write_clean_inputs
from tests.fuzz.oracle import HANG, SLACK, Run, Verdict, content_of, judge

MEMORY = 8 * 2**30
"""Limit of a worker's memory [bytes]."""


class BatteryError(Exception):
    """An error of the battery itself, not of what it tests."""


class Worker:
    """Judges cases; clean runs are made when the first case needs them.

    Parameters
    ----------
    clean
        Folder of the clean inputs.
    room
        Folder for mutated inputs, which is emptied for every case.
    """

    def __init__(self, clean: Path, room: Path) -> None:
        self.clean, self.room = clean, room
        self._known: dict[tuple[str, str], list[tuple[Run, Any]]] = {}

    def judged(self, kind: Kind, case: Case) -> tuple[Verdict, str]:
        """Return the first failure among the commands that read a case, or else the last verdict."""
        verdict, words = Verdict.SAME, ""
        for reading, (before, content) in zip(
            case.readings, self.clean_runs(kind, case.variant), strict=True
        ):
            with _limited(HANG * before.seconds + SLACK):
                run = executed(reading, self.room)
            one, why = judge(run, before, content, case.is_valid)
            if one is not Verdict.SAME:
                verdict, words = one, f"{reading.words[0]}: {why}"
            if one.is_failure:
                break
        return verdict, words

    def case(self, kind: Kind, seed: int) -> Case:
        """Draw the case of a seed, in an empty folder."""
        shutil.rmtree(self.room, ignore_errors=True)
        self.room.mkdir()
        return kind.mutated(self.clean, self.room, np.random.default_rng(seed))

    def clean_runs(self, kind: Kind, variant: str) -> list[tuple[Run, Any]]:
        """Return the runs with a clean input, each with its result."""
        key = (type(kind).__name__, variant)
        if key not in self._known:
            # The first run pays for what is compiled or loaded once.
            for _ in range(2):
                room = self.room.with_name("clean-run")
                shutil.rmtree(room, ignore_errors=True)
                room.mkdir()
                case = kind.clean(self.clean, variant, room)
                runs = [executed(reading, room) for reading in case.readings]
                for run in runs:
                    assert run.status == 0, run.err
                contents = [run.result and content_of(run.result) for run in runs]
            self._known[key] = list(zip(runs, contents, strict=True))
        return self._known[key]


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """End the process if the block takes more processor time, whatever compiled code it is in."""
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    # The limit is in whole seconds, and runs that end late are judged by the oracle.
    used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
    resource.setrlimit(resource.RLIMIT_CPU, (int(used + seconds) + 2, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_CPU, (hard, hard))


def executed(reading: Reading, room: Path) -> Run:
    """Run a command; its standard error is taken from the descriptor, to which libraries write as well."""
    from uvshear.cli.application import run

    before = set(room.rglob("*"))
    used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
    with _caught(room.with_name("standard-error")) as caught, warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            status: int | None = run(list(reading.words))
            words = ""
        except BaseException as error:
            status = None
            place = traceback.extract_tb(error.__traceback__)[-1]
            ours = [p for p in traceback.extract_tb(error.__traceback__) if "uvshear" in p.filename]
            words = (
                f"{type(error).__name__}: {' '.join(str(error).split())} at {place.filename}:{place.lineno}"
                f" from {ours[-1].filename}:{ours[-1].lineno}"
            )
    seconds = sum(resource.getrusage(resource.RUSAGE_SELF)[:2]) - used
    result = reading.result
    stems = () if result is None else (result.name, result.stem)
    expected = {f"{stem}{end}" for stem in stems for end in ("", ".stats.fits", ".sky.fits")}
    # casacore makes lock files in the sets that it reads.
    others = [
        str(path.relative_to(room))
        for path in sorted(set(room.rglob("*")) - before)
        if path.name not in expected
        and path.name != "table.lock"
        and (result is None or result not in path.parents)
    ]
    return Run(status, words or caught.text, result, tuple(others), seconds)


class _Caught:
    text = ""


@contextmanager
def _caught(file: Path) -> Iterator[_Caught]:
    caught, kept = _Caught(), [os.dup(1), os.dup(2)]
    with file.open("wb+") as errors, open(os.devnull, "wb") as null:
        for stream, number in ((sys.stdout, 1), (sys.stderr, 2)):
            stream.flush()
            os.dup2((null if number == 1 else errors).fileno(), number)
        try:
            yield caught
        finally:
            for number, saved in zip((1, 2), kept, strict=True):
                (sys.stdout, sys.stderr)[number - 1].flush()
                os.dup2(saved, number)
                os.close(saved)
            errors.seek(0)
            caught.text = errors.read().decode("utf-8", "backslashreplace")


def serve(connection: Connection, clean: Path, room: Path, kinds: dict[str, Kind]) -> None:
    """Judge the cases that are asked for; the description of a case is told before it is run."""
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.environ.update(MPLBACKEND="Agg", OMP_NUM_THREADS="1")
    try:
        if not clean.exists():
            clean.mkdir()
            write_clean_inputs(clean)
        worker = Worker(clean, room)
        while (asked := connection.recv()) is not None:
            kind, seed = kinds[asked[0]], asked[1]
            case = worker.case(kind, seed)
            worker.clean_runs(kind, case.variant)
            connection.send(case.description)
            connection.send(worker.judged(kind, case))
    except Exception:
        connection.send(BatteryError(traceback.format_exc()))
