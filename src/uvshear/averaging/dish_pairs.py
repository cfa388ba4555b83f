"""Kinds of pairs of dishes, which see the sky with different primary beams."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from uvshear.interferometer.visibilities import Visibilities
from uvshear.typing import Array, Float, Int


@dataclass(frozen=True)
class DishPairs:
    """Kinds of pairs of the dishes of one array, numbered alike for all arrays with the same kinds of dishes.

    Parameters
    ----------
    kind
        Kind of each antenna's dish.
    diameters
        Diameter of each kind of dish [m].
    """

    kind: Int[Array, " antenna"]
    diameters: Float[Array, " kind"]

    @classmethod
    def from_diameters(cls, arrays: Sequence[Float[Array, " _"]]) -> list[Self]:
        """Distinguish the dishes of some arrays, each of which has at least one, by their diameters [m]."""
        found = np.unique(np.concatenate(arrays))
        return [cls(np.searchsorted(found, diameters), found) for diameters in arrays]

    def kinds(self, pair: int) -> tuple[int, int]:
        """Return the kinds of the two dishes of a pair."""
        return divmod(pair, len(self.diameters))

    def divided(self, seen: Visibilities) -> dict[int, Visibilities]:
        """Return the rows of each kind of pair."""
        count = len(self.diameters)
        if count == 1 or seen.integrations is None:
            return {0: seen}
        kinds = np.sort(self.kind[seen.integrations.antennas], axis=1)
        pair = kinds[:, 0] * count + kinds[:, 1]
        return {number: _rows(seen, pair == number) for number in np.unique(pair).tolist()}


def _rows(seen: Visibilities, chosen: Array) -> Visibilities:
    integrations = seen.integrations
    return replace(
        seen,
        uvw=seen.uvw[chosen],
        stokes_i=seen.stokes_i[chosen],
        weights=seen.weights[chosen],
        integrations=None if integrations is None else integrations.select(chosen),
        averages=None if seen.averages is None else seen.averages.select(chosen),
        counts=None,
        hand_powers=None,
    )
