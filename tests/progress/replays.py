"""Recorded runs, replayed to a ``Course``."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from uvshear.progress import Course, Stage

RECORDINGS = sorted(Path(__file__).with_name("recordings").glob("*.json"))


@dataclass(frozen=True)
class Moment:
    """A moment of a run: its time, and the time that is left as it is predicted [s].

    ``is_foreseen`` says whether the stages that are expected are those that came.
    """

    time: float
    total: float
    stage: str
    predicted: float | None
    is_foreseen: bool

    @property
    def true(self) -> float:
        """Time that is left in truth [s]."""
        return self.total - self.time

    @property
    def share(self) -> float:
        """Part of the run that has passed."""
        return self.time / self.total


def replayed(path: Path, slowness: float = 1.0) -> Iterator[Moment]:
    """Yield the moments just after each report and halfway to the next, on a machine that is as slow as this."""
    record = json.loads(path.read_text(encoding="utf-8"))
    now = [0.0]
    course = Course(lambda: now[0])
    total, events = slowness * record["total"], record["events"]
    events = [(slowness * time, what, values) for time, what, values in events]
    came = [values[0][0] for _, what, values in events if what == "begin"]
    is_foreseen = False
    for (time, what, values), (following, *_) in zip(
        events, [*events[1:], (total, "", [])], strict=True
    ):
        now[0] = time
        if what == "begin":
            course.begin(*(Stage(*each) for each in values))
            is_foreseen = [each[0] for each in values] == came
            del came[0]
        elif what == "advance":
            course.advance(*values)
        elif what == "foresee":
            course.foresee(*(Stage(*each) for each in values))
            is_foreseen = [each[0] for each in values] == came
            continue
        else:
            continue
        for at in (time, (time + following) / 2):
            now[0] = at
            yield Moment(at, total, course.stage, course.left, is_foreseen)
