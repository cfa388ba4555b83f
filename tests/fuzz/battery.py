"""The battery: cases of seeds, judged by a worker process that is watched and replaced where it ends."""

import multiprocessing
import signal
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.fuzz.case import Kind
from tests.fuzz.oracle import ERROR, Verdict
from tests.fuzz.worker import BatteryError, serve

LONGEST = 300.0
"""Time in which a worker must answer [s]. One that waits takes no processor time, by which others are limited."""


@dataclass(frozen=True)
class Judged:
    """A case with its verdict."""

    kind: str
    seed: int
    description: str
    verdict: Verdict
    words: str

    def __str__(self) -> str:
        return f"{self.kind} {self.seed} ({self.description}): {self.verdict.value}: {self.words}"


class Watched:
    """A worker process that may end at any time."""

    def __init__(self, clean: Path, room: Path, kinds: Mapping[str, Kind]) -> None:
        self._arguments = (clean, room, dict(kinds))
        self._start()

    def _start(self) -> None:
        # A process that begins anew has none of the threads and run-time checks of the tests.
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs, *self._arguments), daemon=True)
        self._process.start()
        theirs.close()

    def judged(self, kind: str, seed: int) -> Judged:
        """Return the verdict on the case of a seed; the end of the process is one, too."""
        description = "not told"
        try:
            self._connection.send((kind, seed))
            description = self._answer()
            verdict, words = self._answer()
        except (EOFError, ConnectionError, TimeoutError) as error:
            verdict, words = self._ended(error)
        return Judged(kind, seed, description, verdict, words)

    def _answer(self) -> Any:
        if not self._connection.poll(LONGEST):
            raise TimeoutError
        answer = self._connection.recv()
        if isinstance(answer, BatteryError):
            raise answer
        return answer

    def _ended(self, error: Exception) -> tuple[Verdict, str]:
        if isinstance(error, TimeoutError):
            self._process.kill()
        self._process.join()
        code = self._process.exitcode or 0
        self._start()
        if isinstance(error, TimeoutError) or -code in (signal.SIGXCPU, signal.SIGKILL):
            return Verdict.HANG, f"ended after too long ({code})"
        if code == 2 and (line := self._last_words()) is not None:
            return Verdict.REFUSED, line
        return Verdict.CRASH, f"exit code {code}"

    def _last_words(self) -> str | None:
        """Return the one line of a process that casacore has ended, if it has left no unfinished file."""
        room = self._arguments[1]
        lines = room.with_name("standard-error").read_text(errors="replace").splitlines()
        if len(lines) != 1 or not lines[0].startswith(ERROR) or list(room.rglob(".*unfinished*")):
            return None
        return lines[0]

    def close(self) -> None:
        """End the process."""
        with suppress(BrokenPipeError, ConnectionError):
            self._connection.send(None)
        self._process.join(10)
        self._process.kill()


@contextmanager
def watched(clean: Path, room: Path, kinds: Mapping[str, Kind]) -> Iterator[Watched]:
    """Yield a worker, which ends with the block."""
    worker = Watched(clean, room, kinds)
    try:
        yield worker
    finally:
        worker.close()


def tally(judged: Iterable[Judged]) -> str:
    """Return how many cases of each kind had which verdict, one kind a line."""
    counts: dict[str, Counter[str]] = {}
    for one in judged:
        counts.setdefault(one.kind, Counter())[one.verdict.name.lower()] += 1
    return "\n".join(
        f"{kind}: " + ", ".join(f"{count} {name}" for name, count in counter.most_common())
        for kind, counter in counts.items()
    )
