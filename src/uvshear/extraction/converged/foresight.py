"""The number of major cycles that are still to come, for reports of the progress."""

import math
from dataclasses import dataclass
from itertools import pairwise

from uvshear.extraction.converged.history import History
from uvshear.extraction.converged.minor_cycle import MOST_ITERATIONS

FIRST_SHRINKAGE = 0.1
"""Usual factor from the first change of the sky, which begins with the catalogue, to the second one."""

SLOWER = 1.6
"""Ratio of the next factor to this first one. For fields of SKA-Mid and of the VLA (A) it is between 1.6 and 2.6."""

RESTLESS = 0.65
"""Factor after a minor cycle in which the sources have not come to rest. Before MeerKAT, 360 galaxies in 30 arcmin
change by 0.6 to 0.8 times the last change from the third major cycle on."""

REMEMBERED = 2
"""Number of the last factors of which the geometric mean is taken to be the next one."""

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
        """Return the number of further major cycles, if changes go on to shrink as they did in the last ones."""
        known = len(history)
        fewest = self.rough_cycles + 1 - known
        if known == 0:
            return fewest
        shrinkage = self._next_shrinkage(history)
        # The sky has converged when the change that another cycle would bring is below the tolerance.
        left = max(history.change_rms[-1], _NOTHING) * shrinkage
        needed = math.ceil(math.log(self.tolerance / left) / math.log(shrinkage))
        return min(max(fewest, needed, 1), max(self.most - known, 1))

    def _next_shrinkage(self, history: History) -> float:
        """Foresee the factor from one change of the sky to the next."""
        changes = [max(change, _NOTHING) for change in history.change_rms]
        factors = [after / before for before, after in pairwise(changes)]
        if not factors:
            return FIRST_SHRINKAGE
        is_restless = len(history.moves[-1]) == MOST_ITERATIONS
        first = max(SLOWER * factors[0], RESTLESS if is_restless else 0.0)
        last = factors[1:][-REMEMBERED:] or [first]
        mean = math.prod(last) ** (1 / len(last))
        return min(max(mean, LEAST_SHRINKAGE), MOST_SHRINKAGE)
