"""The reports of a long computation about its own progress."""

from collections.abc import Callable
from typing import Self

from uvshear.progress.observer import Observer
from uvshear.progress.stage import Stage

Progress = Callable[[int, int], None]
"""Function that is called with the work done so far and the total work expected, which may change."""


class Meter:
    """Work that is done and work that is expected, stage by stage.

    Without stages, work has any unit, such as galaxies. With stages, a function is told of nanoseconds of one core.

    Parameters
    ----------
    progress
        Function that is called with both, or an observer of the stages.
    """

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._stage: Stage | None = None
        self._before = self._after = 0.0
        self._done = self._expected = 0.0

    @classmethod
    def of_stages(cls, progress: Progress | None) -> Self:
        """Return a meter that reports to an observer alone, because a function would not know what is to come."""
        return cls(progress if isinstance(progress, Observer) else None)

    def begin(self, stage: Stage, *then: Stage) -> None:
        """Begin a stage, and foresee those that follow it."""
        self._before, self._after = self._work, sum(each.cost for each in then)
        self._stage, self._done, self._expected = stage, 0.0, stage.amount
        if isinstance(self._progress, Observer):
            self._progress.begin(stage, *then)

    def foresee(self, *then: Stage) -> None:
        """Foresee other stages after this one than at its beginning."""
        self._after = sum(each.cost for each in then)
        if isinstance(self._progress, Observer):
            self._progress.foresee(*then)

    def expect(self, amount: float) -> None:
        """Expect more units of this stage."""
        self._expected += amount

    def add(self, amount: float = 1.0) -> None:
        """Report units of this stage that are done."""
        self._done += amount
        self._tell()

    def reach(self, done: int, total: int) -> None:
        """Report how much is done of a computation of which this stage consists."""
        amount = self._expected * done / total if total else 0.0
        self.add(max(amount - self._done, 0.0))

    def note(self, **facts: object) -> None:
        """Report facts about this stage: numbers, words and lists, as JSON knows them."""
        if isinstance(self._progress, Observer):
            self._progress.note(facts)

    def finish(self) -> None:
        """Report that nothing is left to do, whatever was expected."""
        self._expected, self._after = self._done, 0.0
        self._tell()
        if isinstance(self._progress, Observer):
            self._progress.finish()

    @property
    def _work(self) -> float:
        return self._before + self._done * self._unit_cost

    @property
    def _unit_cost(self) -> float:
        return 1.0 if self._stage is None else self._stage.unit_cost

    def _tell(self) -> None:
        expected = max(self._expected, self._done)
        if isinstance(self._progress, Observer):
            if self._done:
                self._progress.advance(self._done, expected)
        elif self._progress is not None:
            left = (expected - self._done) * self._unit_cost + self._after
            self._progress(round(self._work), round(self._work + left))
