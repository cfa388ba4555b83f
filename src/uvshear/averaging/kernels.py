"""Numba kernels of the sums over cells of (u, v, w).

A table of cells is an open-addressing hash table: ``places`` holds the number of a cell or -1 in each slot. The cells
are numbered in the order in which they are met. Columns of ``sums`` are those of ``cell_table.COLUMNS``.
"""

import math

import numpy as np

from uvshear.compilation import compiled, inlined

_AXIS, _W_AXIS = 2**23, 2**15


@inlined
def _hash(key, mask):  # type: ignore[no-untyped-def]
    """Mix the bits of a key (the finaliser of MurmurHash3)."""
    mixed = np.uint64(key)
    mixed ^= mixed >> np.uint64(33)
    mixed *= np.uint64(0xFF51AFD7ED558CCD)
    mixed ^= mixed >> np.uint64(33)
    mixed *= np.uint64(0xC4CEB9FE1A85EC53)
    mixed ^= mixed >> np.uint64(33)
    return np.int64(mixed & mask)


@compiled
def find_cell(key, places, keys, count):  # type: ignore[no-untyped-def]
    """Return the number of the cell with this key, which is ``count`` if it is new."""
    mask = np.uint64(places.size - 1)
    at = _hash(key, mask)
    while True:
        cell = places[at]
        if cell < 0:
            places[at] = count
            return count
        if keys[cell] == key:
            return cell
        at = (at + 1) & np.int64(mask)


@compiled
def add_samples(  # type: ignore[no-untyped-def]
    first,
    uvw,
    integrations,
    vis,
    weights,
    chosen,
    per_metre,
    relative_width,
    size,
    places,
    keys,
    sums,
    count,
):
    """Add samples to their cells, row by row, from row ``first`` on, while there is room for a row of new cells.

    Parameters
    ----------
    first
        First row to add.
    uvw
        Baselines [m].
    integrations
        Time and interval of each row [s].
    vis, weights
        Visibilities [Jy] and weights [Jy^-2].
    chosen
        Numbers of the channels.
    per_metre
        Frequency of each chosen channel, over that in the middle of the sub-band.
    relative_width
        Width over frequency of each chosen channel.
    size
        Sizes of the cells along (u, v) and w [m], at the middle of the band.
    places, keys, sums, count
        The table, and the number of its cells.

    Returns
    -------
    int, int
        The first row that was not added, and the number of cells.
    """
    capacity = len(keys)
    for row in range(first, len(uvw)):
        if count + chosen.size > capacity:
            return row, count
        for k in range(chosen.size):
            weight = np.float64(weights[row, chosen[k]])
            if not weight > 0:
                continue
            scale = per_metre[k]
            u, v, w = uvw[row, 0] * scale, uvw[row, 1] * scale, uvw[row, 2] * scale
            value = vis[row, chosen[k]]
            re, im = np.float64(value.real), np.float64(value.imag)
            # The visibility of the opposite baseline is the conjugate.
            if v < 0 or (v == 0 and u < 0):
                u, v, w, im = -u, -v, -w, -im
            i, j, l = round(u / size[0]), round(v / size[0]), round(w / size[1])
            key = (((np.int64(i) + _AXIS) << 24 | (np.int64(j) + _AXIS)) << 16) | (
                np.int64(l) + _W_AXIS
            )
            cell = find_cell(key, places, keys, count)
            if cell == count:
                keys[cell] = key
                sums[cell] = 0
                count += 1
            du, dv, dw = u - i * size[0], v - j * size[0], w - l * size[1]
            s = sums[cell]
            s[0] += weight
            s[1] += weight * re
            s[2] += weight * im
            s[3] += weight * du
            s[4] += weight * dv
            s[5] += weight * dw
            s[6] += weight * du * du
            s[7] += weight * du * dv
            s[8] += weight * du * dw
            s[9] += weight * dv * dv
            s[10] += weight * dv * dw
            s[11] += weight * dw * dw
            s[12] += weight * scale
            s[13] += weight * relative_width[k]
            s[14] += weight * integrations[row, 0]
            s[15] += weight * integrations[row, 1]
    return len(uvw), count


@compiled
def add_cells(other_keys, other_sums, places, keys, sums, count):  # type: ignore[no-untyped-def]
    """Add the sums of other cells, for which there must be room; return the number of cells."""
    for k in range(len(other_keys)):
        cell = find_cell(other_keys[k], places, keys, count)
        if cell == count:
            keys[cell] = other_keys[k]
            sums[cell] = 0
            count += 1
        for column in range(sums.shape[1]):
            sums[cell, column] += other_sums[k, column]
    return count


@compiled
def rehash(keys, count, places):  # type: ignore[no-untyped-def]
    """Fill the hashes of a larger table."""
    mask = np.uint64(places.size - 1)
    places[:] = -1
    for cell in range(count):
        at = _hash(keys[cell], mask)
        while places[at] >= 0:
            at = (at + 1) & np.int64(mask)
        places[at] = cell


@compiled
def cell_indices(keys, indices):  # type: ignore[no-untyped-def]
    """Write the numbers (i, j, l) of cells along u, v and w, of which their keys are made."""
    for k in range(len(keys)):
        key = keys[k]
        indices[k, 0] = ((key >> 40) & (2**24 - 1)) - _AXIS
        indices[k, 1] = ((key >> 16) & (2**24 - 1)) - _AXIS
        indices[k, 2] = (key & (2**16 - 1)) - _W_AXIS


FARTHEST = float(math.floor(_AXIS - 1)), float(_W_AXIS - 1)
"""Largest numbers of cells from the origin along (u, v) and along w."""
