"""A sky whose sources move: the only mutable state of a minor cycle."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from uvshear.execution import Crew
from uvshear.execution.shared_memory import shared_zeros
from uvshear.extraction.converged.interaction import WINDOW
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float

SLOTS = 128
"""Number of changes that are rendered before the image takes them: more than there are workers, and 63 MB at most."""


class MovingSky:
    """Keeps the fits of all sources and the image of their changes in step.

    Parameters
    ----------
    state
        The sky to begin with, which is not changed.
    """

    def __init__(self, state: SkyState) -> None:
        self._now = replace(state, image=state.image.copy())
        # Zeros that nobody writes take no memory.
        self._rendered = shared_zeros((SLOTS, WINDOW, WINDOW), np.float32)

    @property
    def now(self) -> SkyState:
        """The present sky; it is valid until the next move, because its image is updated in place."""
        return self._now

    def move(
        self, sources: list[int], fits: Sequence[GalaxyFit], crew: "SkyCrew"
    ) -> Float[Array, " moved"]:
        """Replace sources by their fits, and return the change of each in units of the noise.

        The crew, whose sky this is, renders the changes and is told the fits.
        """
        now = self._now
        after = list(now.fits)
        change = np.zeros(len(sources))
        pairs = list(zip(sources, fits, strict=True))
        for first in range(0, len(pairs), SLOTS):
            tasks = [(slot, *pair) for slot, pair in enumerate(pairs[first : first + SLOTS])]
            for (slot, source, fit), distance in zip(tasks, crew.map(_render, tasks), strict=True):
                now.image.add(source, self._rendered[slot])
                after[source] = fit
                change[first + slot] = distance
        changes = [new.flux - old.flux for new, old in zip(after, now.subtracted, strict=True)]
        now.image.set_flux_changes(np.array(changes))
        self._now = replace(now, fits=tuple(after))
        crew.tell(MovingSky.adopt, sources, list(fits))
        return change

    def render(self, slot: int, source: int, fit: GalaxyFit) -> float:
        """Render the change of a source to a fit into a slot, and return it in units of the noise."""
        now = self._now
        before, after = (now.placed(source, state) for state in (now.fits[source], fit))
        distance, self._rendered[slot] = now.interaction.render(source, before, after)
        return distance

    def adopt(self, sources: list[int], fits: Sequence[GalaxyFit]) -> None:
        """Replace sources by their fits in a copy of this sky, which sees the image of the changes itself."""
        after = list(self._now.fits)
        for source, fit in zip(sources, fits, strict=True):
            after[source] = fit
        self._now = replace(self._now, fits=tuple(after))


SkyCrew: TypeAlias = Crew[MovingSky]
"""Workers that fit the sources of a sky."""


def _render(sky: MovingSky, task: tuple[int, int, GalaxyFit]) -> float:
    return sky.render(*task)
