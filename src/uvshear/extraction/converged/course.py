"""How far an extraction has come: what the next major or minor cycle begins with."""

from dataclasses import dataclass, field, replace
from typing import Final, Self

from uvshear.extraction.converged.acceleration import Cycle
from uvshear.extraction.converged.baselines import Baselines
from uvshear.extraction.converged.beams import Beams
from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.kept_sky import KeptSky
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.extraction.state_store import StateStore

_COURSE: Final = "course"
_BEAMS: Final = "beams"


@dataclass(frozen=True)
class Course:
    """The state of an extraction between two cycles.

    Parameters
    ----------
    baselines
        Baselines that are used.
    history
        Changes of the sky in the cycles so far.
    cycles
        Cycles from which the next sky is extrapolated.
    state
        The sky after the last cycle; None before the first.
    awaits_minor_cycle
        Whether the last cycle was a major cycle, whose minor cycle comes next.
    has_converged
        Whether no further cycle is needed or allowed.
    """

    baselines: Baselines
    history: History = field(default_factory=History)
    cycles: tuple[Cycle, ...] = ()
    state: SkyState | None = None
    awaits_minor_cycle: bool = False
    has_converged: bool = False


@dataclass(frozen=True)
class _KeptCourse:
    """A course whose sky has the form in which it is stored."""

    course: Course
    sky: KeptSky | None

    @classmethod
    def from_course(cls, course: Course) -> Self:
        return cls(replace(course, state=None), _kept_sky(course))


def _kept_sky(course: Course) -> KeptSky | None:
    if course.state is None:
        return None
    if course.awaits_minor_cycle or course.has_converged:
        return KeptSky.from_state(course.state)
    return KeptSky.for_another_major_cycle(course.state)


def save_course(store: StateStore, course: Course) -> None:
    """Save a course; with its first cycle also the beams, which do not change.

    Between a major cycle and its minor cycle nothing is saved unless much work would be lost.
    """
    if course.awaits_minor_cycle and not store.is_due:
        return
    is_first = len(course.history) + course.awaits_minor_cycle == 1
    if course.state is not None and is_first:
        # What has been computed from them is computed again.
        store.save(_BEAMS, replace(course.state.interaction.beams, _powers={}))
    store.save(_COURSE, _KeptCourse.from_course(course))


def load_baselines(store: StateStore, default: Baselines) -> Baselines:
    """Return the baselines of the course that was saved, or the default if there is none."""
    kept: _KeptCourse | None = store.load(_COURSE)
    return default if kept is None else kept.course.baselines


def load_course(store: StateStore, baselines: Baselines, modelled: ModelledField) -> Course:
    """Return the course with these baselines that was saved last, or one that begins if there is none."""
    kept: _KeptCourse | None = store.load(_COURSE)
    if kept is None or kept.course.baselines.shortest != baselines.shortest:
        return Course(baselines)
    if kept.sky is None:
        return kept.course
    beams: Beams | None = store.load(_BEAMS)
    if beams is None:
        return Course(baselines)
    return replace(kept.course, state=kept.sky.restored(modelled.sources, beams))
