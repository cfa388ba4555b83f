"""One pass over the sources in decreasing flux among neighbours: the Gauss-Seidel iteration.

Sources that are far apart are fitted in parallel, each to the residual of the last major cycle less the changes of its
neighbours since then. Updating all sources at once would diverge; in turn the joint likelihood never falls.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from uvshear.extraction.converged.moving_sky import Move, MovingSky, SkyCrew
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.shapes.blend import Member, fit_group
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Bool, Float

OnFit = Callable[[], None]
"""Function called after each fit."""


def fit_in_turn(
    sky: MovingSky,
    active: Bool[Array, " source"],
    crew: SkyCrew,
    on_fit: OnFit,
    *,
    afresh: bool,
) -> Float[Array, " source"]:
    """Fit the active sources in turn, overlapping ones together; return their changes in units of the noise.

    With ``afresh`` the peak of every source is also searched for from scratch, each source by itself, because the steps
    of a group need a starting point.
    """
    neighbourhood = sky.now.neighbourhood
    everything = neighbourhood.singles if afresh else neighbourhood.units
    units = [unit for unit in everything if active[unit].any()]
    change = np.zeros(len(active))
    for level in neighbourhood.levels(units):
        # Groups take longest: where they came last, all other workers would wait for them.
        longest_first = sorted(level, key=len, reverse=True)
        moves = [Move(unit, partial(_fit_unit, unit=unit, afresh=afresh)) for unit in longest_first]
        change += sky.move(moves, crew, on_fit)
    return change


def _fit_unit(now: SkyState, unit: list[int], *, afresh: bool) -> list[GalaxyFit]:
    if len(unit) > 1 and all(now.fits[source].snr > 0 for source in unit):
        return _fit_group(now, unit)
    return [_fit_source(now, source, afresh=afresh) for source in unit]


def _fit_source(now: SkyState, source: int, *, afresh: bool) -> GalaxyFit:
    last = now.fits[source]
    starts = (None, last) if afresh else (last,)
    return now.sources[source].refit(now.facet(source), starts if last.snr > 0 else (None,))


def _fit_group(now: SkyState, group: list[int]) -> list[GalaxyFit]:
    place = now.neighbourhood.place
    members = [
        Member(
            now.residual(source),
            now.sources[source].prior,
            now.sources[source].profile,
            tuple(place[source] - place[group[0]]),
        )
        for source in group
    ]
    plane = now.interaction.plane_around(group[0])
    return fit_group(members, plane, [now.fits[source] for source in group])
