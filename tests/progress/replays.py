"""Recorded runs, replayed to a ``Course``."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from uvshear.progress import Course, Stage

RECORDINGS = sorted(Path(__file__).with_name("recordings").glob("*.json"))


@dataclass(frozen=True)
class Moment:
    """A moment of a run: its time, and the time that is left as predicted and in truth [s]."""

    time: float
    stage: str
    predicted: float | None
    true: float


def replayed(path: Path) -> Iterator[Moment]:
    """Yield the moments just after each report and halfway to the next."""
    record = json.loads(path.read_text(encoding="utf-8"))
    now = [0.0]
    course = Course(lambda: now[0])
    total, events = record["total"], record["events"]
    for (time, what, values), (following, *_) in zip(events, [*events[1:], [total]], strict=True):
        now[0] = time
        if what == "begin":
            course.begin(*(Stage(*each) for each in values))
        elif what == "advance":
            course.advance(*values)
        else:
            continue
        for at in (time, (time + following) / 2):
            now[0] = at
            yield Moment(at, course.stage, course.left, total - at)
