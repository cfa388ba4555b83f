"""A random draw of rows of arrays that come in parts, whose total number is not known beforehand."""

import numpy as np

from uvshear.typing import Array, Float, Int, Shaped

Columns = tuple[Shaped[Array, "drawn *_"], ...]
"""Arrays of equal length."""


class Reservoir:
    """Keeps rows that are drawn with equal probabilities.

    Every row has a random number between 0 and 1, and rows whose number is below a limit are kept. The limit is lowered
    whenever there are too many.

    Parameters
    ----------
    most
        Largest number of rows that are returned; at most twice as many are held.
    """

    def __init__(self, most: int) -> None:
        self._generator = np.random.default_rng(0)
        self._most, self._limit, self._held = most, 1.0, 0
        self._parts: list[tuple[Float[Array, " drawn"], Columns]] = []

    def __len__(self) -> int:
        return self._held

    def draw(self, size: int) -> tuple[Int[Array, " drawn"], Float[Array, " drawn"]]:
        """Choose from a part of ``size`` rows; return the places of those that are drawn, and their numbers."""
        if size * self._limit > 2 * self._most:
            self._lower(2 * self._most / size)
        count = size if self._limit == 1 else self._generator.binomial(size, self._limit)
        places = np.arange(size)
        if count < size:
            places = np.sort(self._generator.choice(size, count, replace=False, shuffle=False))
        return places, self._generator.uniform(0, self._limit, len(places))

    def add(self, numbers: Float[Array, " drawn"], columns: Columns) -> None:
        """Keep rows that were drawn, with their numbers."""
        if len(numbers):
            self._parts.append((numbers, columns))
            self._held += len(numbers)
        while self._held > 2 * self._most:
            self._lower(self._limit / 2)

    def merge(self, later: "Reservoir") -> None:
        """Take over the rows of another reservoir."""
        self._lower(min(self._limit, later._limit))
        for numbers, columns in later._parts:
            kept = numbers < self._limit
            self.add(numbers[kept], tuple(column[kept] for column in columns))

    def columns(self) -> Columns:
        """Return the rows that were drawn, in the order in which they came; an empty tuple if there are none."""
        if not self._held:
            return ()
        numbers = np.concatenate([part for part, _ in self._parts])
        lowest = np.sort(np.argsort(numbers)[: self._most])
        parts = zip(*(columns for _, columns in self._parts), strict=True)
        return tuple(np.concatenate(column)[lowest] for column in parts)

    def _lower(self, limit: float) -> None:
        if limit >= self._limit:
            return
        self._limit = limit
        parts, self._parts, self._held = self._parts, [], 0
        for numbers, columns in parts:
            kept = numbers < limit
            if kept.any():
                self._parts.append((numbers[kept], tuple(column[kept] for column in columns)))
                self._held += int(kept.sum())
