"""The order in which sources are fitted, and the sources that may be fitted in parallel."""

import numpy as np
from scipy.spatial import cKDTree

from uvshear.typing import Array, Float, Int


def fitting_levels(
    lm: Float[Array, "source 2"], flux: Float[Array, " source"], separation: float
) -> tuple[Int[Array, " member"], ...]:
    """Sort sources by level: each comes after all brighter ones within ``separation`` [rad] of it.

    Within a level no two sources are closer than that. The order of fluxes matters between neighbours only, so that the
    result is the same as in one long sequence of decreasing flux, in as many steps as the longest chain of neighbours
    has members.
    """
    if len(lm) == 0:
        return ()
    neighbours = cKDTree(lm).query_ball_point(lm, separation)
    order = np.argsort(-flux, kind="stable")
    rank = np.empty(len(order), int)
    rank[order] = np.arange(len(order))
    level = np.zeros(len(order), int)
    for source in order:
        brighter = [j for j in neighbours[source] if rank[j] < rank[source]]
        level[source] = 1 + max((level[j] for j in brighter), default=-1)
    return tuple(order[level[order] == value] for value in range(int(level.max()) + 1))
