"""Statistics of all galaxies of a released sky, for estimators of the shear."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

from uvshear.execution import Executor
from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.extraction.extraction import Setting
from uvshear.extraction.state_store import NO_STORE, Results
from uvshear.geometry.directions import PhaseCentre
from uvshear.shapes.source_facet import Kept, SourceFacet, Statistic, noise_named
from uvshear.shapes.statistic_flag import StatisticFlag, flag_column
from uvshear.typing import Array, Float

BYTES_PER_WORKER = 1.5e8
"""Memory in which the statistics of one source are computed, measured with those of all estimators; what they keep for
several sources takes another 0.4 GB at most."""

MOST_IN_A_PART = 100
"""Largest number of galaxies in a task. A decomposition of the likelihood takes as long as the statistics of 20
galaxies; with smaller parts, more workers would compute the same decomposition. In small fields parts are smaller;
otherwise some workers would have nothing to do. The statistics do not depend on the parts."""


def keep_statistics(
    state: SkyState,
    modelled: ModelledField,
    setting: Setting,
    phase_centre: PhaseCentre,
    executor: Executor,
    on_source: Callable[[], None],
    known: Results[Kept] | None = None,
) -> Mapping[int, Kept]:
    """Compute the statistics of every galaxy, with a flag for each estimator, by index of the catalogue.

    Statistics that are known already, by the number of the galaxy among the modelled sources, are not computed again;
    the others are added to them.
    """
    subject = _Kept(
        state,
        modelled,
        replace(setting, store=NO_STORE),
        phase_centre,
        modelled.strength_at_1_4_ghz,
    )
    known = Results() if known is None else known
    workers = min(setting.resources.memory // BYTES_PER_WORKER, executor.workers)
    executor = executor.at_most(int(workers))
    most = min(
        MOST_IN_A_PART, math.ceil(len(modelled.galaxies) / (2 * executor.distributed_workers))
    )
    left = [k for k in modelled.galaxies if k not in known]
    parts = _by_beam(state, left, most)
    for part, found in zip(parts, executor.distribute(_statistics, subject, parts), strict=True):
        for k, numbers in zip(part, found, strict=True):
            on_source()
            known.add(k, numbers)
    return {int(modelled.field.modelled[k]): known[k] for k in modelled.galaxies}


@dataclass(frozen=True)
class _Kept:
    """What the statistics of all galaxies are computed from."""

    state: SkyState
    modelled: ModelledField
    setting: Setting
    phase_centre: PhaseCentre
    strength: Float[Array, " source"]


def _statistics(subject: _Kept, part: Sequence[int]) -> list[Kept]:
    return [_of_source(subject, k) for k in part]


def _of_source(subject: _Kept, k: int) -> Kept:
    seen = _seen(
        subject.state,
        subject.modelled,
        subject.setting,
        subject.phase_centre,
        k,
        float(subject.strength[k]),
    )
    numbers: dict[str, float | Array | str] = {}
    for statistic in subject.setting.keep:
        numbers |= _numbers(statistic, seen)
    return numbers


def _numbers(statistic: Statistic, seen: SourceFacet) -> Kept:
    """Return the numbers of one estimator, and its flag if it has a name."""
    found = statistic.statistic(seen) if seen.facet.has_power else StatisticFlag.NO_DATA
    if found is None:
        found = StatisticFlag.NOT_FITTED
    numbers: Kept = {} if isinstance(found, StatisticFlag) else found
    flag = found if isinstance(found, StatisticFlag) else StatisticFlag.OK
    name = getattr(statistic, "name", "")
    return {**numbers, flag_column(name): flag.word} if name else numbers


def _by_beam(state: SkyState, galaxies: Sequence[int], most: int) -> list[list[int]]:
    """Divide galaxies into parts with the same cells and the same beam, in which similar sizes follow one another."""
    cutouts, mixtures = state.interaction.plan.cutouts, state.interaction.beams.mixtures

    def beam(k: int) -> tuple[int, float, tuple[int, ...]]:
        return cutouts[k].size, cutouts[k].longest, mixtures[k].beams

    def size(k: int) -> float:
        return state.sources[k].prior.log_scale_length

    return _divided(galaxies, beam, size, most)


def _divided(
    galaxies: Sequence[int],
    kind: Callable[[int], tuple[Any, ...]],
    size: Callable[[int], float],
    most: int,
) -> list[list[int]]:
    """Divide galaxies into parts of one kind and of at most ``most`` galaxies, in the order of their sizes.

    What estimators compute for all galaxies of a kind and of similar sizes takes more time than what they compute for a
    single galaxy. A part is therefore the work of one worker. The largest parts come first, so that all workers finish
    at about the same time.
    """
    ordered = sorted(galaxies, key=lambda k: (kind(k), size(k)))
    parts = [
        same[first : first + most]
        for same in (list(group) for _, group in groupby(ordered, key=kind))
        for first in range(0, len(same), most)
    ]
    return sorted(parts, key=len, reverse=True)


def _seen(
    state: SkyState,
    modelled: ModelledField,
    setting: Setting,
    phase_centre: PhaseCentre,
    k: int,
    strength: float,
) -> SourceFacet:
    """Describe a source for estimators, with fluxes at 1.4 GHz, to which populations refer, whatever the facet's."""
    facet, source = state.facet(k), int(modelled.field.modelled[k])
    return SourceFacet(
        facet=facet.in_other_unit(strength),
        cells=state.interaction.plan.cutouts[k],
        prior=state.sources[k].prior.measured,
        flux=float(modelled.field.sky.flux[source]),
        profile=setting.model.profile,
        population=setting.model.population,
        draw_noise=noise_named(modelled.field.name(source, phase_centre), len(facet.power)),
        unit=strength,
        beam=facet.power,
    )
