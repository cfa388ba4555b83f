"""Numba kernel of averaging into cells."""

import numpy as np

from uvshear.compilation import compiled


@compiled
def add_to_cells(u, v, vis, weights, gain, cell, sums, power):  # type: ignore[no-untyped-def]
    """Add gain x weight x visibility, and gain^2 x weight, to square cells of side ``cell``.

    Samples of negative v are folded onto the other half plane. ``sums`` and ``power`` are (2 half, half) in
    (u, v), cell (i, j) reaching from (i - half, j) to (i - half + 1, j + 1) in units of the cell.
    """
    half = sums.shape[1]
    for k in range(u.size):
        if weights[k] <= 0:
            continue
        uk, vk, d = u[k] / cell, v[k] / cell, vis[k]
        if vk < 0:
            uk, vk, d = -uk, -vk, np.conj(d)
        i, j = int(np.floor(uk)) + half, int(vk)
        if 0 <= i < 2 * half and j < half:
            sums[i, j] += gain * weights[k] * d
            power[i, j] += gain * gain * weights[k]
