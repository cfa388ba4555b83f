"""The time that a computation still needs, judged by what its stages have taken so far.

The cost of every stage is estimated beforehand (``Stage.cost``), and a stage takes

    seconds = cost * pace of its kind.

The pace of a kind is the mean over its stages so far; a kind without one has the mean pace of all work so far. The pace
of the stage that is under way begins with this value, and approaches the stage's own pace as more of the stage is done.
The pace that is known beforehand (``Stage.pace``) enters the mean of all work as well; its weight there declines as
more work is done.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from uvshear.progress.stage import Stage

SEEN, UNSEEN = 0.5, 0.3
"""Part of a stage after which its own pace counts as much as that of earlier stages, of its kind or of other kinds."""

BEFOREHAND = 0.15
"""Part of all work that has to be done before the pace that it shows counts as much as the one known beforehand."""

OVERDUE = 0.1
"""Time that a stage needs at least to its next report, over what it was expected to need."""


@dataclass(frozen=True)
class Finished:
    """Work that is done, and the time that it took [s]."""

    kind: str
    cost: float
    seconds: float


@dataclass(frozen=True)
class Running:
    """The stage that is under way.

    Parameters
    ----------
    stage
        The stage as it was expected.
    since
        Time at which it began [s].
    done, expected
        Units that are done and that are expected in all, by the last report.
    reported
        Time of the last report [s].
    done_before, reported_before
        Units that were done by an earlier report, and its time [s]: since then, half of what is done or more was done.
    """

    stage: Stage
    since: float
    done: float
    expected: float
    reported: float
    done_before: float = 0.0
    reported_before: float | None = None

    @property
    def cost(self) -> float:
        """Work that the whole stage is expected to be."""
        return self.expected * self.stage.unit_cost if self.stage.cost > 0 else 0.0

    @property
    def so_far(self) -> Finished:
        """The part of it that is done."""
        share = min(self.done / self.expected, 1.0) if self.expected > 0 else 0.0
        return Finished(kind_of(self.stage), share * self.cost, self.reported - self.since)

    @property
    def lately(self) -> Finished:
        """The part that was done lately: what comes first in a stage may take longer than the rest."""
        since = self.since if self.reported_before is None else self.reported_before
        share = (self.done - self.done_before) / self.expected if self.expected > 0 else 0.0
        return Finished(kind_of(self.stage), share * self.cost, self.reported - since)


def kind_of(stage: Stage) -> str:
    """Return the kind of a stage; a stage without one is of its own kind."""
    return stage.kind or stage.name


def time_left(
    finished: Sequence[Finished], running: Running, then: Sequence[Stage], now: float
) -> float | None:
    """Return the time that is left [s]; None while nothing is known of the pace or of what is to come.

    Parameters
    ----------
    finished
        Stages that have ended.
    running
        The stage that is under way.
    then
        Stages that are expected to follow.
    now
        Present time [s].
    """
    if running.cost <= 0:
        return None
    part, lately = running.so_far, running.lately
    known = [each for each in (*finished, lately) if each.cost > 0]
    is_first = known == [lately] and running.stage.pace <= 0
    if is_first and running.reported_before is None:
        return None  # the first report comes late where something is prepared before
    foreseen = known
    if running.stage.pace > 0:
        to_come = running.cost - part.cost + sum(stage.cost for stage in then)
        whole = to_come + part.cost + sum(each.cost for each in finished)
        imagined = BEFOREHAND * whole
        foreseen = [*known, Finished("", imagined, imagined * running.stage.pace)]
    overall = pace(foreseen)
    if overall is None:
        return None
    alike = [each for each in finished if each.kind == part.kind and each.cost > 0]
    before = pace(alike)
    # What the stage has shown counts in proportion to the part of it that is done.
    weight = (UNSEEN if before is None else SEEN) * running.cost
    # What is little known counts little.
    weight = min(weight, sum(each.cost for each in alike or foreseen))
    expected = overall if before is None else before
    own = (lately.seconds + weight * expected) / (lately.cost + weight)
    left = (running.cost - part.cost) * own
    left = max(left - (now - running.reported), OVERDUE * left)
    # There may be hundreds of stages, of few kinds.
    paces = dict.fromkeys(map(kind_of, then), overall)
    for kind in paces:
        seen = pace([each for each in known if each.kind == kind])
        if kind == part.kind and before is None:
            seen = own
        if seen is not None:
            paces[kind] = seen
    return left + sum(stage.cost * paces[kind_of(stage)] for stage in then)


def pace(finished: Sequence[Finished]) -> float | None:
    """Return the time that a unit of cost has taken [s]; None if nothing has been done."""
    cost = sum(each.cost for each in finished)
    return sum(each.seconds for each in finished if each.cost > 0) / cost if cost > 0 else None
