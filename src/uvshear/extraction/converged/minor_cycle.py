"""Between two major cycles: sources are fitted until none moves any more.

First in turn (``sequential_pass``), which finds the right peaks, and those that overlap are fitted together
(``shapes.blend``). Then all take one Gauss-Newton step together (``joint_step``): the broad plateau of the beam lets
whole neighbourhoods creep where each waits for the others. Both are repeated until little moves.
"""

from dataclasses import replace

import numpy as np

from uvshear.execution import Executor
from uvshear.extraction.converged.joint_step import step_jointly
from uvshear.extraction.converged.moving_sky import MovingSky
from uvshear.extraction.converged.sequential_pass import OnFit, fit_in_turn
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.typing import Array, Float

MOST_ITERATIONS = 4
"""Number of sequential passes, each with its joint step, at most."""

CONVERGED = 0.1
"""The iterations end when all together move by this part of what the first pass moved them: the interaction is known no
better than that, and the next major cycle measures it."""

CONVERGED_ENOUGH = 0.5
"""They also end when all together move by less than this part of the tolerance."""

Moves = tuple[tuple[float, float], ...]
"""Largest change of a source in each iteration, in the sequential pass and in the joint step [noise]."""


def run_minor_cycle(
    state: SkyState, tolerance: float, executor: Executor, on_fit: OnFit, *, afresh: bool
) -> tuple[SkyState, Moves]:
    """Fit in turn and step together, until no source changes by ``tolerance`` of the noise.

    Parameters
    ----------
    state
        The sky to begin with; it stays as it is. Its couplings are taken, if it has any.
    tolerance
        Change that counts as none, in units of the noise.
    executor
        Runs fits side by side.
    on_fit
        Called after each fit.
    afresh
        Whether the first pass looks for the peak of every source from scratch.
    """
    sky = MovingSky(state)
    linearisation = state.linearisation
    moves: list[tuple[float, float]] = []
    enough = 0.0
    active = np.ones(len(state.sources), bool)
    for number in range(MOST_ITERATIONS):
        is_afresh = afresh and number == 0
        in_turn = fit_in_turn(sky, active, executor, on_fit, afresh=is_afresh)
        couplings = None if linearisation is None else linearisation.couplings
        together, linearisation = step_jointly(sky, couplings, tolerance, executor)
        moves.append((float(in_turn.max()), float(together.max())))
        enough = enough or max(CONVERGED * rms(in_turn), CONVERGED_ENOUGH * tolerance)
        # Sources that overlap are fitted together from the second pass on.
        if rms(together) < enough and not is_afresh:
            break
        restless = np.flatnonzero(np.maximum(in_turn, together) > tolerance)
        if len(restless) == 0:
            break
        active = state.neighbourhood.around(restless)
    return replace(sky.now, linearisation=linearisation), tuple(moves)


def rms(values: Float[Array, " _"]) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
