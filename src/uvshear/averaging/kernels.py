"""Numba kernels of the sums over cells of (u, v, w).

A table of cells is an open-addressing hash table: ``places`` holds the number of a cell or -1 in each slot. The cells
are numbered in the order in which they are met. The columns of ``sums`` are listed in ``cell_sums``.
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
    order,
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
    """Add samples to their cells, row by row, while there is room for a row of new cells.

    Parameters
    ----------
    first
        First place in ``order`` of which the row is added.
    order
        Rows in the order in which they are added. It is fast if neighbours lie in the same cells.
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
        The first place of which the row was not added, and the number of cells.
    """
    capacity = len(keys)
    last = np.full(chosen.size, -1, np.int64)
    per_uv, per_w = 1 / size[0], 1 / size[1]
    for at in range(first, len(order)):
        if count + chosen.size > capacity:
            return at, count
        row = order[at]
        time, interval = integrations[row, 0], integrations[row, 1]
        for k in range(chosen.size):
            weight = np.float64(weights[row, chosen[k]])
            if not weight > 0:
                continue
            scale = per_metre[k]
            u, v, w = uvw[row, 0] * scale, uvw[row, 1] * scale, uvw[row, 2] * scale
            value = vis[row, chosen[k]]
            re, im = weight * np.float64(value.real), weight * np.float64(value.imag)
            # The visibility of the opposite baseline is the conjugate.
            if v < 0 or (v == 0 and u < 0):
                u, v, w, im = -u, -v, -w, -im
            u, v, w = u * per_uv, v * per_uv, w * per_w
            i, j, l = round(u), round(v), round(w)
            key = (((np.int64(i) + _AXIS) << 24 | (np.int64(j) + _AXIS)) << 16) | (
                np.int64(l) + _W_AXIS
            )
            cell = last[k]
            if cell < 0 or keys[cell] != key:
                cell = np.int64(find_cell(key, places, keys, count))
                last[k] = cell
                if cell == count:
                    keys[cell] = key
                    sums[cell] = 0
                    count += 1
            u, v, w = u - i, v - j, w - l
            s = sums[cell]
            s[0] += weight
            s[1] += re
            s[2] += im
            s[3] += re * u
            s[4] += im * u
            s[5] += re * v
            s[6] += im * v
            s[7] += re * w
            s[8] += im * w
            pu, pv, pw = weight * u, weight * v, weight * w
            s[9] += pu
            s[10] += pv
            s[11] += pw
            puu, puv, puw, pvv, pvw, pww = pu * u, pu * v, pu * w, pv * v, pv * w, pw * w
            s[12] += puu
            s[13] += puv
            s[14] += puw
            s[15] += pvv
            s[16] += pvw
            s[17] += pww
            puuu, puuv, puuw, puvv, puvw = puu * u, puu * v, puu * w, puv * v, puv * w
            puww, pvvv, pvvw, pvww, pwww = puw * w, pvv * v, pvv * w, pvw * w, pww * w
            s[18] += puuu
            s[19] += puuv
            s[20] += puuw
            s[21] += puvv
            s[22] += puvw
            s[23] += puww
            s[24] += pvvv
            s[25] += pvvw
            s[26] += pvww
            s[27] += pwww
            s[28] += puuu * u
            s[29] += puuu * v
            s[30] += puuu * w
            s[31] += puuv * v
            s[32] += puuv * w
            s[33] += puuw * w
            s[34] += puvv * v
            s[35] += puvv * w
            s[36] += puvw * w
            s[37] += puww * w
            s[38] += pvvv * v
            s[39] += pvvv * w
            s[40] += pvvw * w
            s[41] += pvww * w
            s[42] += pwww * w
            s[43] += weight * scale
            s[44] += pu * scale
            s[45] += pv * scale
            s[46] += pw * scale
            s[47] += weight * relative_width[k]
            s[48] += weight * time
            s[49] += weight * interval
    return len(order), count


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
