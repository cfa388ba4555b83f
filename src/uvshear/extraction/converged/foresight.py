"""The number of major cycles that are still to come, for reports of the progress."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

from uvshear.extraction.converged.history import History

FIRST_SHRINKAGE = 0.1
"""Usual factor from the first change of the sky, which begins with the catalogue, to the second one."""

SLOWER = 1.6
"""Ratio of the next factor to this first one. For fields of SKA-Mid and of the VLA (A) it is between 1.6 and 2.6."""

RESTLESS = 0.7
"""Least factor after a minor cycle in which the sources have not come to rest. With MeerKAT, 360 galaxies in 30
arcmin change by 0.6 to 0.8 times the last change from the third major cycle on, in the geometric mean by 0.70."""

REMEMBERED = 3
"""Number of the last factors of which the geometric mean is taken to be the next one."""

USUAL = 2
"""Number of major cycles that are foreseen before the first one, if none of them is rough."""

LEAST_SHRINKAGE, MOST_SHRINKAGE = 0.05, 0.8
"""Range of the factors that are believed."""

_NOTHING = 1e-9
"""Change that is none [noise]."""


@dataclass(frozen=True)
class Foresight:
    """Foresees the number of major cycles.

    Parameters
    ----------
    tolerance
        Change below which the sky has converged [noise].
    rough_cycles
        Number of major cycles without the longest baselines; at least one with all baselines follows.
    most
        Largest number of major cycles.
    """

    tolerance: float
    rough_cycles: int
    most: int

    def cycles_to_come(self, history: History) -> int:
        """Return the number of further major cycles, if changes go on to shrink as they did in the last ones.

        A change that is larger than the one before it is that of a few sources which have jumped: with MeerKAT a
        change of 0.23 was followed by 0.83, and this by 0.09. It does not go on, and changes shrink further from those
        before it.
        """
        known = len(history)
        fewest = self.rough_cycles + 1 - known
        if known == 0:
            return min(max(fewest, USUAL), self.most)
        trend = list(accumulate((max(each, _NOTHING) for each in history.change_rms), min))
        shrinkage = self._next_shrinkage(trend, is_restless=history.is_restless)
        last, coming, most = max(history.change_rms[-1], _NOTHING), trend[-1], self.most - known
        for needed in range(1, most):
            before, coming = (last if needed == 1 else coming), coming * shrinkage
            # The sky has converged when the change that another cycle would bring is below the tolerance.
            if needed >= fewest and coming * min(coming / before, 1.0) <= self.tolerance:
                return needed
        return max(most, 1)

    def _next_shrinkage(self, trend: Sequence[float], *, is_restless: bool) -> float:
        """Foresee the factor from one change of the sky to the next."""
        factors = [after / before for before, after in pairwise(trend)]
        if not factors:
            return FIRST_SHRINKAGE
        last = factors[1:][-REMEMBERED:] or [SLOWER * factors[0]]
        mean = math.prod(last) ** (1 / len(last))
        least = RESTLESS if is_restless else LEAST_SHRINKAGE
        return min(max(mean, least), MOST_SHRINKAGE)
