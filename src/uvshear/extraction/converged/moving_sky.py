"""The sky during a minor cycle, the only mutable state of the cycle.

Its sources are refitted (position, flux, size and ellipticity), which is called a move.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import TypeAlias

import numpy as np

from uvshear.execution import Crew
from uvshear.execution.shared_memory import shared_zeros
from uvshear.extraction.converged.interaction import WINDOW
from uvshear.extraction.converged.sky_state import SkyState
from uvshear.shapes.measurement import GalaxyFit
from uvshear.typing import Array, Float

SLOTS = 512
"""Largest number of rendered changes that wait to be added to the image; they occupy 254 MB. The number does not depend
on the number of workers, nor therefore do the fits."""

_UNITS = 16
"""Number of units of sources whose changes one task computes."""

Find: TypeAlias = "Callable[[SkyState], list[GalaxyFit]]"
"""A picklable function that finds new fits of the sources of a move."""


@dataclass(frozen=True)
class Move:
    """Sources that are to move, and how their new fits are found."""

    sources: Sequence[int]
    find: Find


@dataclass(frozen=True)
class Given:
    """A ``Find`` that returns a fit that is already known."""

    fit: GalaxyFit

    def __call__(self, now: SkyState) -> list[GalaxyFit]:
        """Return the fit."""
        return [self.fit]


class MovingSky:
    """Keeps the fits of all sources consistent with the image of their changes.

    Parameters
    ----------
    state
        The sky to begin with, which is not changed.
    now
        The present sky, if it is another one.
    """

    def __init__(self, state: SkyState, now: SkyState | None = None) -> None:
        self._before, now = state.fits, now or state
        # The workers do without the linearisation, which is large.
        self._now = replace(now, image=now.image.copy(), linearisation=None)
        # Zeros that nobody writes take no memory.
        self._rendered = shared_zeros((SLOTS, WINDOW, WINDOW), np.float32)

    @property
    def now(self) -> SkyState:
        """The present sky; it is valid until the next move, because its image is updated in place."""
        return self._now

    def move(
        self, moves: Sequence[Move], crew: "SkyCrew", on_move: Callable[[], None] | None = None
    ) -> Float[Array, " source"]:
        """Let sources move; return the change of each source's model, sqrt(<dm, dm>), that is, in units of the noise.

        The sources of one move share the change of the sum of their models. All fits start from the sky before the
        call. If more than ``SLOTS`` sources move, they are divided into batches; a later batch sees the image with the
        changes of the earlier ones, but their old fits.

        The crew, which must hold this sky, finds the fits and renders the changes, and is sent the new fits at the end.
        ``on_move`` is called after each move.
        """
        after = dict[int, GalaxyFit]()
        change = np.zeros(len(self._now.fits))
        for batch in _batches(moves):
            tasks: list[_Task] = []
            slots = iter(range(SLOTS))
            for move in batch:
                tasks.append((move, tuple(islice(slots, len(move.sources)))))
            for (move, _), found in zip(tasks, crew.map(_moved, tasks), strict=True):
                for source, (fit, distance) in zip(move.sources, found, strict=True):
                    after[source], change[source] = fit, distance
                if on_move is not None:
                    on_move()
            self._add_rendered(tasks, crew)
        self.adopt(after)
        now = self._now
        changes = [new.flux - old.flux for new, old in zip(now.fits, now.subtracted, strict=True)]
        now.image.set_flux_changes(np.array(changes))
        crew.tell(MovingSky.adopt, after)
        return change

    def change(self, crew: "SkyCrew") -> Float[Array, " source"]:
        """Return the change of each source since the beginning, in units of the noise (``SkyState.change_of_unit``)."""
        units = self._now.neighbourhood.units
        parts = [units[first : first + _UNITS] for first in range(0, len(units), _UNITS)]
        change = np.zeros(len(self._now.fits))
        for part, found in zip(parts, crew.map(MovingSky.changes_of, parts), strict=True):
            for unit, of_unit in zip(part, found, strict=True):
                change[unit] = of_unit
        return change

    def changes_of(self, units: Sequence[list[int]]) -> list[float]:
        """Return the change of each of some units of sources since the beginning."""
        return [self._now.change_of_unit(unit, self._before) for unit in units]

    def _add_rendered(self, tasks: "Sequence[_Task]", crew: "SkyCrew") -> None:
        """Add the changes to the image: strips of it side by side, and the changes of each strip in their order."""
        strips: dict[int, _Placed] = {}
        for move, taken in tasks:
            for source, slot in zip(move.sources, taken, strict=True):
                for strip in self._now.image.strips_of(source):
                    strips.setdefault(strip, []).append((source, slot))
        for _ in crew.map(MovingSky.add_to_strip, sorted(strips.items())):
            pass

    def add_to_strip(self, strip: "tuple[int, _Placed]") -> None:
        """Add rendered changes, given by their sources and slots, to one strip of the image, which copies share."""
        number, placed = strip
        for source, slot in placed:
            self._now.image.add_to_strip(number, source, self._rendered[slot])

    def render(self, slot: int, source: int, fit: GalaxyFit) -> float:
        """Render the change of a source to a fit into a slot, and return it in units of the noise."""
        now = self._now
        before, after = (now.placed(source, state) for state in (now.fits[source], fit))
        return now.interaction.render(source, before, after, self._rendered[slot])

    def adopt(self, fits: Mapping[int, GalaxyFit]) -> None:
        """Replace the fits of some sources. The image, which the copies share, already contains the changes."""
        after = list(self._now.fits)
        for source, fit in fits.items():
            after[source] = fit
        self._now = replace(self._now, fits=tuple(after))


SkyCrew: TypeAlias = Crew[MovingSky]
"""Workers that fit the sources of a sky."""

_Task: TypeAlias = tuple[Move, tuple[int, ...]]
"""A move, and the slots of its sources."""

_Placed: TypeAlias = list[tuple[int, int]]
"""Sources and the slots with their changes."""


def _moved(sky: MovingSky, task: _Task) -> list[tuple[GalaxyFit, float]]:
    move, slots = task
    fits = move.find(sky.now)
    changes = [
        sky.render(slot, source, fit)
        for slot, source, fit in zip(slots, move.sources, fits, strict=True)
    ]
    if len(fits) > 1:
        unit = list(move.sources)
        changes = [sky.now.change_of_unit(unit, dict(zip(unit, fits, strict=True)))] * len(fits)
    return list(zip(fits, changes, strict=True))


def _batches(moves: Sequence[Move]) -> Iterator[list[Move]]:
    """Divide moves into lists whose sources have slots."""
    batch: list[Move] = []
    held = 0
    for move in moves:
        if batch and held + len(move.sources) > SLOTS:
            yield batch
            batch, held = [], 0
        batch.append(move)
        held += len(move.sources)
    yield batch
