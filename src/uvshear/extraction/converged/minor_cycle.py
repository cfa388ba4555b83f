"""One minor cycle: between two major cycles, sources are fitted until none of them moves.

They are first fitted in turn (``sequential_pass``), which finds the right peaks, and those that overlap are fitted
together (``shapes.blend``). Then all take one Gauss-Newton step together (``joint_step``), because the broad plateau of
the beam couples whole neighbourhoods, which sequential fits move only slowly. Both are repeated until the sources
hardly move.
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from uvshear.execution import Executor
from uvshear.extraction.converged.change_image import ChangeImage, Changes
from uvshear.extraction.converged.joint_step import step_jointly
from uvshear.extraction.converged.moving_sky import MovingSky
from uvshear.extraction.converged.sequential_pass import OnFit, fit_in_turn
from uvshear.extraction.converged.sky_state import Fits, Linearisation, SkyState
from uvshear.extraction.state_store import NO_STORE, StateStore
from uvshear.typing import Array, Bool, Float

MOST_ITERATIONS = 4
"""Largest number of sequential passes, each of which is followed by a joint step."""

CONVERGED = 0.1
"""The iterations end when the joint step is this fraction of the first pass: the interaction is no more accurate than
that, and the next major cycle corrects it."""

CONVERGED_ENOUGH = 0.5
"""They also end when the joint step is less than this fraction of the tolerance."""

_NAME: Final = "minor-cycle"

Moves = tuple[tuple[float, float], ...]
"""Largest change of a source in each iteration, in the sequential pass and in the joint step [noise]."""


@dataclass(frozen=True)
class MinorCycle:
    """Results of a minor cycle.

    Parameters
    ----------
    state
        The sky at its end.
    moves
        Largest changes in each iteration.
    change
        Change of each source, in units of the noise; that of overlapping sources is the change of their sum.
    """

    state: SkyState
    moves: Moves
    change: Float[Array, " source"]


@dataclass(frozen=True)
class _Iterated:
    """A minor cycle between two iterations.

    Parameters
    ----------
    label
        Name of the minor cycle.
    fits, changes
        Fits of the sources, and the content of the image of changes; None before the first iteration.
    linearisation
        The log posterior about the sky of the last joint step; None before the first.
    active
        Sources that are fitted in the next iteration.
    moves
        Largest changes in the iterations so far.
    enough
        Joint step with which the cycle ends [noise]; 0 before the first iteration.
    """

    label: str
    fits: Fits
    changes: Changes | None
    linearisation: Linearisation | None
    active: Bool[Array, " source"]
    moves: Moves = ()
    enough: float = 0.0

    @classmethod
    def at_the_start(cls, state: SkyState, label: str) -> "_Iterated":
        everything = np.ones(len(state.sources), bool)
        return cls(label, state.fits, None, state.linearisation, everything)

    def sky(self, state: SkyState) -> MovingSky:
        """Return the sky of a cycle that began with a state."""
        if self.changes is None:
            return MovingSky(state)
        image = ChangeImage.from_changes(state.interaction, self.changes)
        return MovingSky(state, replace(state, fits=self.fits, image=image))


def run_minor_cycle(
    state: SkyState,
    tolerance: float,
    executor: Executor,
    on_fit: OnFit,
    *,
    afresh: bool,
    store: StateStore = NO_STORE,
    label: str = "",
) -> MinorCycle:
    """Fit the sources in turn and let them step together, until the changes are below ``tolerance`` of the noise.

    Parameters
    ----------
    state
        The sky to begin with, which is not changed. Its couplings are used, if it has any.
    tolerance
        Change of the sources below which they have converged, in units of the noise.
    executor
        Executor of the fits.
    on_fit
        Function called after each fit.
    afresh
        Whether the first pass looks for the peak of every source from scratch.
    store
        Place for the state between two iterations, which is saved where much work would be lost.
    label
        Name of the minor cycle: a state that another one has saved is not used.
    """
    reached: _Iterated | None = store.load(_NAME)
    if reached is None or reached.label != label:
        reached = _Iterated.at_the_start(state, label)
    sky = reached.sky(state)
    state.interaction.work_out_planes()
    linearisation, active = reached.linearisation, reached.active
    moves, enough = reached.moves, reached.enough
    with executor.crew(sky) as crew:
        while len(moves) < MOST_ITERATIONS:
            is_afresh = afresh and not moves
            in_turn = fit_in_turn(sky, active, crew, on_fit, afresh=is_afresh)
            couplings = None if linearisation is None else linearisation.couplings
            together, linearisation = step_jointly(sky, couplings, tolerance, crew)
            moves = (*moves, (float(in_turn.max()), float(together.max())))
            enough = enough or max(CONVERGED * rms(in_turn), CONVERGED_ENOUGH * tolerance)
            # Sources that overlap are fitted together from the second pass on.
            if rms(together) < enough and not is_afresh:
                break
            restless = np.flatnonzero(np.maximum(in_turn, together) > tolerance)
            if len(restless) == 0:
                break
            active = state.neighbourhood.around(restless)
            if store.is_due:
                now = sky.now
                changes = now.image.changes()
                kept = _Iterated(label, now.fits, changes, linearisation, active, moves, enough)
                store.save(_NAME, kept)
        change = sky.change(crew)
    return MinorCycle(replace(sky.now, linearisation=linearisation), moves, change)


def rms(values: Float[Array, " _"]) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
