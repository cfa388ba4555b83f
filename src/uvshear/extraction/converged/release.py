"""The sky with a very wide prior on ellipticities, from which statistics for the shear are taken.

A prior pulls a faint galaxy towards round, and all its neighbours, near and far, absorb a little of the shape that it
lacks, and with it of the shear.
"""

from dataclasses import dataclass, replace
from typing import Final

from uvshear.execution import Executor
from uvshear.extraction.converged.kept_sky import KeptSky
from uvshear.extraction.converged.minor_cycle import rms, run_minor_cycle
from uvshear.extraction.converged.moving_sky import Given, Move, MovingSky
from uvshear.extraction.converged.sequential_pass import OnFit
from uvshear.extraction.converged.sky_state import Fits, SkyState
from uvshear.extraction.converged.sources import ModelledSource
from uvshear.extraction.state_store import NO_STORE, StateStore
from uvshear.shapes.measurement import GalaxyFit
from uvshear.shapes.template import difference

RELEASES = 3
"""Number of minor cycles of a released sky. Thirty galaxies, 17 to a square arcminute, lose 10.3 % of their moments
with the prior, 3.0 % after one minor cycle, 1.0 % after two, 0.5 % after three with the extrapolation, and 0.4 % after
twelve."""

FARTHEST_AHEAD = 1.0
"""Longest extrapolation of a released sky, over its last move."""

_NAME: Final = "sky"


@dataclass(frozen=True)
class _Released:
    """A sky some minor cycles after its release.

    Parameters
    ----------
    sky
        The sky, in the form in which it is stored.
    before
        The fits before the last minor cycle.
    moves
        The rms of the changes in the minor cycles so far [noise].
    """

    sky: KeptSky
    before: Fits
    moves: tuple[float, ...]


def release(
    state: SkyState,
    tolerance: float,
    executor: Executor,
    on_fit: OnFit,
    store: StateStore = NO_STORE,
) -> tuple[SkyState, tuple[float, ...]]:
    """Let the sky converge with a very wide prior on ellipticities; return it with the rms of its moves [noise].

    Each minor cycle takes the sky about half of the remaining way. A few cycles are therefore followed by an
    extrapolation to the limit that their moves suggest. The sky is stored at the end, and before where much work
    would be lost.
    """
    sources = tuple(source.released() for source in state.sources)
    kept: _Released | None = store.load(_NAME)
    moves: tuple[float, ...]
    if kept is None:
        now, before, moves = replace(state, sources=sources), state.fits, ()
    else:
        found = kept.sky.restored(state.sources, state.interaction.beams)
        now, before, moves = replace(found, sources=sources), kept.before, kept.moves
    while len(moves) < RELEASES:
        before = now.fits
        label = f"released {len(moves)}"
        cycle = run_minor_cycle(
            now, tolerance, executor, on_fit, afresh=False, store=store, label=label
        )
        now, moves = cycle.state, (*moves, rms(cycle.change))
        if store.is_due or len(moves) == RELEASES:
            store.save(_NAME, _Released(KeptSky.from_state(now), before, moves))
    first, second = moves[-2:]
    # Moves that do not shrink tell of no end.
    far = min(second / (first - second), FARTHEST_AHEAD) if second < first else 0.0
    ahead = [
        _ahead(source, then, fit, far)
        for source, then, fit in zip(now.sources, before, now.fits, strict=True)
    ]
    sky = MovingSky(now)
    with executor.crew(sky) as crew:
        sky.move([Move([k], Given(fit)) for k, fit in enumerate(ahead)], crew)
    return sky.now, moves


def _ahead(source: ModelledSource, then: GalaxyFit, now: GalaxyFit, far: float) -> GalaxyFit:
    """Return a source as far beyond ``now`` as it came from ``then``, times ``far``."""
    if min(then.snr, now.snr) <= 0:
        return now
    return source.after_step(now, far * difference(now, then))
