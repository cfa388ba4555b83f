"""Groups of sources that overlap so much that they are fitted together."""

import numpy as np
from scipy.spatial import cKDTree

from uvshear.typing import Array, Float

OVERLAP = 3.0
"""Sources closer than this times the sum of their scale lengths are fitted together."""

MOST_MEMBERS = 8
"""Largest number of sources in a group. The closest are joined first; the others are fitted in turn."""


def overlapping_groups(
    place: Float[Array, "source 2"], scale_length: Float[Array, " source"]
) -> list[list[int]]:
    """Divide sources into groups that overlap; a source without overlap is a group of one.

    Each group is in rising order, and so are the groups by their first member.
    """
    group_of = list(range(len(place)))
    groups = {source: [source] for source in group_of}
    reach = 2 * OVERLAP * float(scale_length.max(initial=0.0))
    pairs = cKDTree(place).query_pairs(reach, output_type="ndarray")
    if len(pairs):
        first, second = pairs.T
        apart = np.hypot(*(place[first] - place[second]).T)
        overlap = apart / np.maximum(scale_length[first] + scale_length[second], 1e-30)
        order = np.lexsort((second, first, overlap))
        for i, j in pairs[order[overlap[order] < OVERLAP]].tolist():
            a, b = group_of[i], group_of[j]
            if a == b or len(groups[a]) + len(groups[b]) > MOST_MEMBERS:
                continue
            for source in groups[b]:
                group_of[source] = a
            groups[a] += groups.pop(b)
    return sorted(sorted(group) for group in groups.values())
