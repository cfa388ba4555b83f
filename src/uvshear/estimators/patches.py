"""Patches of the sky with equal numbers of sources, which a jackknife leaves out in turn."""

import numpy as np

from uvshear.errors import InputError
from uvshear.typing import Array, Float, Int


def sky_patches(
    l: Float[Array, " source"], m: Float[Array, " source"], count: int
) -> Int[Array, " source"]:
    """Return the number of the patch of each source.

    The field is divided across the longer of its two sides, with equal numbers of sources per patch, and each part is
    divided in the same way.

    Parameters
    ----------
    l, m
        Direction cosines of the sources.
    count
        Number of patches, at least 2 and at most the number of sources.
    """
    if not 2 <= count <= len(l):
        raise InputError(
            f"{count} patches of the sky for {len(l)} sources; at least 2 patches, and a source for each, are needed"
        )
    patch = np.zeros(len(l), int)
    waiting = [(np.arange(len(l)), 0, count)]
    while waiting:
        members, first, number = waiting.pop()
        patch[members] = first
        if number == 1:
            continue
        axis = l if np.ptp(l[members]) >= np.ptp(m[members]) else m
        order = members[np.argsort(axis[members], kind="stable")]
        near = number // 2
        split = len(order) * near // number
        waiting += [(order[:split], first, near), (order[split:], first + near, number - near)]
    return patch
