"""The course of a computation, as far as an observer has heard of it."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from uvshear.progress.observer import Observer
from uvshear.progress.stage import Stage
from uvshear.progress.time_left import Finished, Running, time_left

UNKNOWN = Stage("")
"""Work of a computation that tells of no stages."""


class Course(Observer):
    """Knows the stage that is under way, its rate, and the time that is left.

    Parameters
    ----------
    clock
        Function that returns the time [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._start = clock()
        self._finished: list[Finished] = []
        self._running = Running(UNKNOWN, self._start, 0.0, 0.0, self._start)
        self._then: Sequence[Stage] = ()
        self._furthest = 0.0
        # A report after which as much is to be done as before it.
        self._mark = 0.0, self._start

    def begin(self, stage: Stage, *then: Stage) -> None:
        """Note that a stage begins."""
        now = self._end_stage()
        self._running, self._then = Running(stage, now, 0.0, stage.amount, now), then
        self._mark = 0.0, now

    def advance(self, done: float, expected: float) -> None:
        """Note how far the stage is."""
        running = self._running
        if running.stage is UNKNOWN:
            running = replace(running, stage=Stage("", 1.0))
        now = self._clock()
        if done >= 2 * self._mark[0] > 0:
            running = replace(running, done_before=self._mark[0], reported_before=self._mark[1])
            self._mark = done, now
        elif not self._mark[0]:
            self._mark = done, now
        self._running = replace(running, done=done, expected=expected, reported=now)

    def foresee(self, *then: Stage) -> None:
        """Note which stages are now expected."""
        self._then = then

    def note(self, facts: Mapping[str, object]) -> None:
        """Do nothing: facts do not tell of the time."""

    def finish(self) -> None:
        """Note that the last stage has ended."""
        now = self._end_stage()
        self._running, self._then = Running(UNKNOWN, now, 0.0, 0.0, now), ()

    @property
    def stage(self) -> str:
        """Name of the stage that is under way; empty if it has none."""
        return self._running.stage.name

    @property
    def unit(self) -> str:
        """What the stage consists of; empty if its rate is of no interest."""
        return self._running.stage.unit

    @property
    def rate(self) -> float | None:
        """Units of the stage that are done in a second; None before the first report."""
        running = self._running
        seconds = running.reported - running.since
        return running.done / seconds if running.done > 0 and seconds > 0 else None

    @property
    def elapsed(self) -> float:
        """Time since the beginning [s]."""
        return self._clock() - self._start

    @property
    def left(self) -> float | None:
        """Time that is left [s]; None if it is not known."""
        return time_left(self._finished, self._running, self._then, self._clock())

    @property
    def share(self) -> float:
        """Share of the whole time that has passed, which never falls."""
        left, elapsed = self.left, self.elapsed
        if left is not None and elapsed > 0:
            self._furthest = max(self._furthest, elapsed / (elapsed + left))
        return self._furthest

    def _end_stage(self) -> float:
        now, running = self._clock(), self._running
        if running.stage is not UNKNOWN:
            self._finished.append(replace(running.so_far, seconds=now - running.since))
        return now
