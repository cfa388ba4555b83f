"""A sky whose sources move: the only mutable state of a minor cycle."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from uvshear.execution import Crew, Executor
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float


class MovingSky:
    """Keeps the fits of all sources and the image of their changes in step.

    Parameters
    ----------
    state
        The sky to begin with, which is not changed.
    """

    def __init__(self, state: SkyState) -> None:
        self._now = replace(state, image=state.image.copy())

    @property
    def now(self) -> SkyState:
        """The present sky; it is valid until the next move, because its image is updated in place."""
        return self._now

    def move(
        self, sources: list[int], fits: Sequence[GalaxyFit], executor: Executor
    ) -> Float[Array, " moved"]:
        """Replace sources by their fits, and return the change of each in units of the noise."""
        now = self._now

        def render(task: tuple[int, GalaxyFit]) -> tuple[float, Float[Array, "l m"]]:
            source, fit = task
            before, after = (now.placed(source, state) for state in (now.fits[source], fit))
            return now.interaction.render(source, before, after)

        after = list(now.fits)
        change = np.zeros(len(sources))
        tasks = list(zip(sources, fits, strict=True))
        for k, (distance, rendered) in enumerate(executor.map(render, tasks)):
            source, fit = tasks[k]
            now.image.add(source, rendered)
            after[source] = fit
            change[k] = distance
        pairs = zip(after, now.subtracted, strict=True)
        now.image.set_flux_changes(np.array([new.flux - old.flux for new, old in pairs]))
        self._now = replace(now, fits=tuple(after))
        return change

    def adopt(self, sources: list[int], fits: Sequence[GalaxyFit]) -> None:
        """Replace sources by their fits in a copy of this sky, which sees the image of the changes itself."""
        after = list(self._now.fits)
        for source, fit in zip(sources, fits, strict=True):
            after[source] = fit
        self._now = replace(self._now, fits=tuple(after))


SkyCrew: TypeAlias = Crew[MovingSky]
"""Workers that fit the sources of a sky."""
