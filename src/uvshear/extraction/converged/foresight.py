"""The number of major cycles that are still to come, for reports of the progress."""

import math
from dataclasses import dataclass

from uvshear.extraction.converged.history import History

USUAL_SHRINKAGE = 0.3
"""Factor from one change of the sky to the next where nothing is known of it."""

LEAST_SHRINKAGE, MOST_SHRINKAGE = 0.05, 0.8
"""Range of the factors that are believed."""


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
        """Return the number of further major cycles, if changes go on to shrink as they did in the last one."""
        known = len(history)
        fewest = self.rough_cycles + 1 - known
        if known == 0:
            return fewest
        shrinkage = history.shrinkage if known > 1 else USUAL_SHRINKAGE
        shrinkage = min(max(shrinkage, LEAST_SHRINKAGE), MOST_SHRINKAGE)
        # The sky has converged when the change that another cycle would bring is below the tolerance.
        left = max(history.change_rms[-1], 1e-9) * shrinkage
        needed = math.ceil(math.log(self.tolerance / left) / math.log(shrinkage))
        return min(max(fewest, needed, 1), max(self.most - known, 1))
