"""One minor cycle: between two major cycles, sources are fitted until none of them moves.

They are first fitted in turn (``sequential_pass``), which finds the right peaks, and those that overlap are fitted
together (``shapes.blend``). Then all take one Gauss-Newton step together (``joint_step``), because the broad plateau of
the beam couples whole neighbourhoods, which sequential fits move only slowly. Both are repeated until the sources
hardly move.
"""

from dataclasses import dataclass, replace

import numpy as np

from uvshear.execution import Executor
from uvshear.extraction.converged.joint_step import step_jointly
from uvshear.extraction.converged.moving_sky import MovingSky
from uvshear.extraction.converged.sequential_pass import OnFit, fit_in_turn
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.typing import Array, Float

MOST_ITERATIONS = 4
"""Largest number of sequential passes, each of which is followed by a joint step."""

CONVERGED = 0.1
"""The iterations end when the joint step is this fraction of the first pass: the interaction is no more accurate than
that, and the next major cycle corrects it."""

CONVERGED_ENOUGH = 0.5
"""They also end when the joint step is less than this fraction of the tolerance."""

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


def run_minor_cycle(
    state: SkyState, tolerance: float, executor: Executor, on_fit: OnFit, *, afresh: bool
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
    """
    sky = MovingSky(state)
    state.interaction.work_out_planes()
    with executor.crew(sky) as crew:
        linearisation = state.linearisation
        moves: list[tuple[float, float]] = []
        enough = 0.0
        active = np.ones(len(state.sources), bool)
        for number in range(MOST_ITERATIONS):
            is_afresh = afresh and number == 0
            in_turn = fit_in_turn(sky, active, crew, on_fit, afresh=is_afresh)
            couplings = None if linearisation is None else linearisation.couplings
            together, linearisation = step_jointly(sky, couplings, tolerance, crew)
            moves.append((float(in_turn.max()), float(together.max())))
            enough = enough or max(CONVERGED * rms(in_turn), CONVERGED_ENOUGH * tolerance)
            # Sources that overlap are fitted together from the second pass on.
            if rms(together) < enough and not is_afresh:
                break
            restless = np.flatnonzero(np.maximum(in_turn, together) > tolerance)
            if len(restless) == 0:
                break
            active = state.neighbourhood.around(restless)
        change = sky.change(crew)
    return MinorCycle(replace(sky.now, linearisation=linearisation), tuple(moves), change)


def rms(values: Float[Array, " _"]) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
