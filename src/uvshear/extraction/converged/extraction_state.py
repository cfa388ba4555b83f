"""The state of an extraction between two cycles, with which the same or another run goes on."""

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

_SKY: Final = "sky"
_BEAMS: Final = "beams"


@dataclass(frozen=True)
class ExtractionState:
    """The state of an extraction between two cycles.

    Parameters
    ----------
    baselines
        Baselines that are used.
    history
        Changes of the sky in the cycles so far.
    cycles
        Cycles from which the next sky is extrapolated.
    sky
        The sky after the last cycle; None before the first.
    awaits_minor_cycle
        Whether the last cycle was a major cycle, whose minor cycle comes next.
    has_converged
        Whether no further cycle is needed or allowed.
    """

    baselines: Baselines
    history: History = field(default_factory=History)
    cycles: tuple[Cycle, ...] = ()
    sky: SkyState | None = None
    awaits_minor_cycle: bool = False
    has_converged: bool = False


@dataclass(frozen=True)
class _KeptState:
    """A state whose sky has the form in which it is stored."""

    state: ExtractionState
    sky: KeptSky | None

    @classmethod
    def from_state(cls, state: ExtractionState) -> Self:
        return cls(replace(state, sky=None), _kept_sky(state))


def _kept_sky(state: ExtractionState) -> KeptSky | None:
    if state.sky is None:
        return None
    if state.awaits_minor_cycle or state.has_converged:
        return KeptSky.from_state(state.sky)
    return KeptSky.for_another_major_cycle(state.sky)


def save_extraction(store: StateStore, state: ExtractionState) -> None:
    """Save a state; with the first cycle also the beams, which do not change.

    Between a major cycle and its minor cycle nothing is saved unless much work would be lost.
    """
    if state.awaits_minor_cycle and not store.is_due:
        return
    is_first = len(state.history) + state.awaits_minor_cycle == 1
    if state.sky is not None and is_first:
        # What has been computed from them is computed again.
        store.save(_BEAMS, replace(state.sky.interaction.beams, _powers={}))
    store.save(_SKY, _KeptState.from_state(state))


def load_baselines(store: StateStore, default: Baselines) -> Baselines:
    """Return the baselines of the state that was saved, or the default if there is none."""
    kept: _KeptState | None = store.load(_SKY)
    return default if kept is None else kept.state.baselines


def load_extraction(
    store: StateStore, baselines: Baselines, modelled: ModelledField
) -> ExtractionState:
    """Return the state with these baselines that was saved last, or that of a beginning if there is none."""
    kept: _KeptState | None = store.load(_SKY)
    if kept is None or kept.state.baselines.shortest != baselines.shortest:
        return ExtractionState(baselines)
    if kept.sky is None:
        return kept.state
    beams: Beams | None = store.load(_BEAMS)
    if beams is None:
        return ExtractionState(baselines)
    return replace(kept.state, sky=kept.sky.restored(modelled.sources, beams))
