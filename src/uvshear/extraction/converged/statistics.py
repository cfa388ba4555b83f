"""Statistics of all galaxies of a released sky, for estimators of the shear."""

from collections.abc import Callable, Mapping

import numpy as np

from uvshear.extraction.converged.modelled_field import ModelledField
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.extraction.extraction import Setting
from uvshear.geometry.directions import PhaseCentre
from uvshear.shapes.source_facet import Kept, SourceFacet, noise_named
from uvshear.typing import Array


def keep_statistics(
    state: SkyState,
    modelled: ModelledField,
    setting: Setting,
    phase_centre: PhaseCentre,
    on_source: Callable[[], None],
) -> Mapping[int, Kept]:
    """Compute the statistics of every galaxy that has any, by index of the catalogue."""
    strength = modelled.strength_at_1_4_ghz

    def statistics(k: int) -> Kept:
        seen = _seen(state, modelled, setting, phase_centre, k, float(strength[k]))
        numbers: dict[str, float | Array] = {}
        if np.any(seen.facet.power > 0):
            for statistic in setting.keep:
                numbers.update(statistic.statistic(seen) or {})
        return numbers

    kept: dict[int, Kept] = {}
    galaxies = modelled.galaxies
    for k, numbers in zip(
        galaxies, setting.resources.executor.map(statistics, galaxies), strict=True
    ):
        on_source()
        if numbers:
            kept[int(modelled.field.modelled[k])] = numbers
    return kept


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
    )
