"""The residual facets of a major cycle with the part of each source's own model that the image of changes lacks."""

from collections.abc import Sequence
from dataclasses import dataclass

from uvshear.execution import Executor
from uvshear.extraction.converged.interaction import Interaction
from uvshear.extraction.converged.major_cycle import Facets, MajorCycle, shared_facets
from uvshear.extraction.converged.sources import ModelledSource
from uvshear.imaging.cutout import Cutout
from uvshear.shapes.measurement import GalaxyFit

AT_A_TIME = 64
"""Number of sources in a task."""


def with_own_models(
    cycle: MajorCycle,
    interaction: Interaction,
    sources: Sequence[ModelledSource],
    subtracted: Sequence[GalaxyFit],
    executor: Executor,
) -> Facets:
    """Centre each residual facet on its source, and add the part of its own model that the image of changes lacks.

    Parameters
    ----------
    cycle
        The major cycle that gave the residuals.
    interaction
        The beam of that cycle, and the part of it that the image of changes holds.
    sources
        The modelled sources.
    subtracted
        The fits that the cycle has subtracted.
    executor
        Executor of the work.
    """
    _work_out_powers(cycle, interaction, executor)
    facets = shared_facets([len(facet) for facet in cycle.residuals])
    adding = _Adding(cycle, interaction, sources, subtracted, facets)
    with executor.crew(adding) as crew:
        for _ in crew.map(_add, range(0, len(facets), AT_A_TIME)):
            pass
    return facets


@dataclass(frozen=True)
class _Adding:
    """What all tasks have in common; they write into ``facets``."""

    cycle: MajorCycle
    interaction: Interaction
    sources: Sequence[ModelledSource]
    subtracted: Sequence[GalaxyFit]
    facets: Facets


def _add(adding: _Adding, first: int) -> None:
    cycle = adding.cycle
    for k in range(first, min(first + AT_A_TIME, len(adding.facets))):
        cutout = cycle.plan.cutouts[k]
        left = cycle.beams.power(k, cutout) - adding.interaction.own_power(k)
        model = adding.sources[k].model(adding.subtracted[k], cutout.uv)
        facet = adding.facets[k]
        facet[:] = cycle.residuals[k]
        cutout.recentre(facet, tuple(cycle.plan.offset[k]))
        facet += left * model


def _work_out_powers(cycle: MajorCycle, interaction: Interaction, executor: Executor) -> None:
    """Compute what sources with the same beams and cells share, which copies of this process then know."""
    firsts: dict[tuple[Cutout, tuple[int, ...]], int] = {}
    for k, (cutout, mixture) in enumerate(
        zip(cycle.plan.cutouts, cycle.beams.mixtures, strict=True)
    ):
        firsts.setdefault((cutout, mixture.beams), k)

    def work_out(k: int) -> None:
        cycle.beams.power(k, cycle.plan.cutouts[k])
        interaction.own_power(k)

    for _ in executor.map(work_out, firsts.values()):
        pass
