"""Numba kernels of averaging into cells."""

import numpy as np

from uvshear.compilation import compiled
from uvshear.geometry.kernels import sine_cosine_of_turns

ROWS = 512
"""Number of samples whose coordinates and visibilities fit into the level-1 cache."""


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


@compiled
def average_source(samples, per_metre, centre, own, amplitude, limits, gain, into):  # type: ignore[no-untyped-def]
    """Add a source to the samples, move the phase centre to its facet, and add them to the cells (``add_to_cells``).

    Parameters
    ----------
    samples
        Baselines (3, row) [m], visibilities without the source [Jy], and weights.
    per_metre
        Wavelengths in a metre.
    centre, own
        (l, m, n - 1) of the facet and of the source.
    amplitude
        Absolute value of the source's visibilities [Jy].
    limits
        Shortest and longest baseline that is used [wavelengths], as seen from the centre of the facet.
    gain
        Flux in this channel over that at the reference frequency.
    into
        Side of a cell [wavelengths], ``sums`` and ``power``.
    """
    uvw, residual, weights = samples
    cell, sums, power = into
    least, most = limits[0] ** 2, limits[1] ** 2
    l, m, n1 = centre[0] * per_metre, centre[1] * per_metre, centre[2] * per_metre
    slope_l, slope_m = centre[0] / (1 + centre[2]), centre[1] / (1 + centre[2])
    away = own - centre
    x, y, z = away[0] * per_metre, away[1] * per_metre, away[2] * per_metre
    u, v, used = np.empty(ROWS), np.empty(ROWS), np.empty(ROWS)
    vis = np.empty(ROWS, np.complex128)
    for start in range(0, amplitude.size, ROWS):
        count = min(ROWS, amplitude.size - start)
        rows = slice(start, start + count)
        x_metres, y_metres, z_metres = uvw[0, rows], uvw[1, rows], uvw[2, rows]
        data, model, weight = residual[rows], amplitude[rows], weights[rows]
        for i in range(count):
            a, b, w = x_metres[i], y_metres[i], z_metres[i]
            sine, cosine = sine_cosine_of_turns(a * l + b * m + w * n1)
            own_sine, own_cosine = sine_cosine_of_turns(a * x + b * y + w * z)
            real, imaginary = data[i].real, data[i].imag
            vis[i] = complex(
                real * cosine + imaginary * sine + model[i] * own_cosine,
                imaginary * cosine - real * sine + model[i] * own_sine,
            )
            u[i] = (a - w * slope_l) * per_metre
            v[i] = (b - w * slope_m) * per_metre
            squared = u[i] * u[i] + v[i] * v[i]
            used[i] = weight[i] if least <= squared <= most else 0.0
        add_to_cells(u[:count], v[:count], vis[:count], used[:count], gain, cell, sums, power)
