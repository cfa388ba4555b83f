"""Numba kernels that find the nodes of cells."""

import math

import numpy as np

from uvshear.averaging.cell_sums import (
    FOURTH,
    FREQUENCY,
    FREQUENCY_TIMES,
    PLACE,
    SECOND,
    THIRD,
    VISIBILITY,
    VISIBILITY_TIMES,
)
from uvshear.compilation import compiled, inlined

_RE, _IM = VISIBILITY.start, VISIBILITY.start + 1
_RE_TIMES, _PLACE, _SECOND, _THIRD, _FOURTH = (
    each.start for each in (VISIBILITY_TIMES, PLACE, SECOND, THIRD, FOURTH)
)
_FREQUENCY_TIMES = FREQUENCY_TIMES.start

_PAIR = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])
"""Places of the products of two coordinates."""

_TRIPLE = np.array(
    [
        [[0, 1, 2], [1, 3, 4], [2, 4, 5]],
        [[1, 3, 4], [3, 6, 7], [4, 7, 8]],
        [[2, 4, 5], [4, 7, 8], [5, 8, 9]],
    ]
)
"""Places of the products of three coordinates."""

_QUADRUPLES = np.array(
    [[a, b, c, d] for a in range(3) for b in range(a, 3) for c in range(b, 3) for d in range(c, 3)]
)
"""The products of four coordinates, in their order."""

_TRIANGLE = np.array(
    [
        [math.sqrt(2), 0.0],
        [-math.sqrt(0.5), math.sqrt(1.5)],
        [-math.sqrt(0.5), -math.sqrt(1.5)],
    ]
)
_TETRAHEDRON = np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
"""Corners whose mean is 0 and whose matrix of second moments is the unit matrix."""


@inlined
def _factored(sums, cell, smallest, mean, root, inverse):  # type: ignore[no-untyped-def]
    """Find the Cholesky factor of the covariance of a cell, with pivots; return its rank.

    Columns of ``root`` are those of the factor, and rows of ``inverse`` give the whitened coordinates z. Axes along
    which the remaining variance is ``smallest`` or less are left out.
    """
    rest = np.empty(3)
    for a in range(3):
        mean[a] = sums[cell, _PLACE + a] / sums[cell, 0]
        rest[a] = sums[cell, _SECOND + _PAIR[a, a]] / sums[cell, 0] - mean[a] ** 2
    for rank in range(3):
        pivot = 0
        for a in range(1, 3):
            if rest[a] > rest[pivot]:
                pivot = a
        if not rest[pivot] > smallest:
            return rank
        length = math.sqrt(rest[pivot])
        for a in range(3):
            value = sums[cell, _SECOND + _PAIR[a, pivot]] / sums[cell, 0] - mean[a] * mean[pivot]
            inverse[rank, a] = 0.0
            for q in range(rank):
                value -= root[a, q] * root[pivot, q]
            root[a, rank] = value / length
            rest[a] -= root[a, rank] ** 2
        inverse[rank, pivot] = 1.0
        for q in range(rank):
            for a in range(3):
                inverse[rank, a] -= root[pivot, q] * inverse[q, a]
        for a in range(3):
            inverse[rank, a] /= length
        rest[pivot] = 0.0
    return 3


@compiled
def count_nodes(sums, smallest, counts):  # type: ignore[no-untyped-def]
    """Write the number of nodes of each cell."""
    mean, root, inverse = np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    for cell in range(len(sums)):
        counts[cell] = 1 + _factored(sums, cell, smallest, mean, root, inverse)


@inlined
def _third_moment(sums, cell, mean, a, b, c):  # type: ignore[no-untyped-def]
    """Third moment about the mean."""
    weight = sums[cell, 0]
    raw = sums[cell, _THIRD + _TRIPLE[a, b, c]] / weight
    raw -= mean[a] * sums[cell, _SECOND + _PAIR[b, c]] / weight
    raw -= mean[b] * sums[cell, _SECOND + _PAIR[a, c]] / weight
    raw -= mean[c] * sums[cell, _SECOND + _PAIR[a, b]] / weight
    return raw + 2 * mean[a] * mean[b] * mean[c]


@inlined
def _fourth_moment(sums, cell, mean, number):  # type: ignore[no-untyped-def]
    """Fourth moment about the mean."""
    weight = sums[cell, 0]
    raw, product = sums[cell, _FOURTH + number] / weight, 1.0
    for one in range(4):
        product *= mean[_QUADRUPLES[number, one]]
    for one in range(4):
        p, q, r = (one + 1) % 4, (one + 2) % 4, (one + 3) % 4
        a, b = _QUADRUPLES[number, one], _QUADRUPLES[number, p]
        c, d = _QUADRUPLES[number, q], _QUADRUPLES[number, r]
        raw -= mean[a] * sums[cell, _THIRD + _TRIPLE[b, c, d]] / weight
        # Around the ring of the four, each pair of neighbours is met once, and each pair of opposite ones twice.
        raw += mean[a] * mean[b] * sums[cell, _SECOND + _PAIR[c, d]] / weight
        raw += 0.5 * mean[a] * mean[c] * sums[cell, _SECOND + _PAIR[b, d]] / weight
    return raw - 3 * product


@inlined
def _symmetric_square(form, number):  # type: ignore[no-untyped-def]
    """Coefficient of the square of a form of second degree."""
    a, b = _QUADRUPLES[number, 0], _QUADRUPLES[number, 1]
    c, d = _QUADRUPLES[number, 2], _QUADRUPLES[number, 3]
    return (
        form[_PAIR[a, b]] * form[_PAIR[c, d]]
        + form[_PAIR[a, c]] * form[_PAIR[b, d]]
        + form[_PAIR[a, d]] * form[_PAIR[b, c]]
    ) / 3


@compiled
def find_nodes(  # type: ignore[no-untyped-def]
    sums, smallest, turned, place, share, vis, frequency, second, fourth, cell_of
):
    """Write the nodes of all cells, one cell after the other.

    Parameters
    ----------
    sums
        Sums over the samples of each cell.
    smallest
        Variance [cell^2] up to which the samples are not told apart along an axis.
    turned
        Whether the corners of a triangle or a tetrahedron are those opposite to the usual ones.
    place
        Coordinates of the nodes from the middles of their cells [cell].
    share
        Weight of each node over that of its cell.
    vis
        Real and imaginary part of the visibility.
    frequency
        Frequency over that in the middle of the sub-band.
    second
        Second moments of what the node stands for [cell^2].
    fourth
        Coefficients of the loss beyond them [cell^4].
    cell_of
        Number of the cell.
    """
    mean, root, inverse = np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    third, z, moved = np.empty((3, 6)), np.empty((4, 3)), np.empty(3)
    spread = np.empty(6)
    row = 0
    for cell in range(len(sums)):
        weight = sums[cell, 0]
        rank = _factored(sums, cell, smallest, mean, root, inverse)
        # Mean of each whitened coordinate times products of two others.
        for r in range(rank):
            for a in range(3):
                for b in range(a, 3):
                    total = 0.0
                    for c in range(3):
                        total += inverse[r, c] * _third_moment(sums, cell, mean, a, b, c)
                    third[r, _PAIR[a, b]] = total
        share_each = 1 / (rank + 1)
        if rank == 0:
            z[0, 0] = 0.0
        elif rank == 1:
            # Gaussian quadrature: the nodes are the roots of the second orthogonal polynomial, z^2 - skew z - 1.
            skew = 0.0
            for a in range(3):
                for b in range(3):
                    skew += inverse[0, a] * inverse[0, b] * third[0, _PAIR[a, b]]
            z[0, 0] = (skew + math.sqrt(skew * skew + 4)) / 2 if skew > 0 else 0.0
            if skew > 0:
                z[1, 0] = -1 / z[0, 0]
            else:
                z[1, 0] = (skew - math.sqrt(skew * skew + 4)) / 2
                z[0, 0] = -1 / z[1, 0]
        elif rank == 2:
            z[:3, :2] = -_TRIANGLE if turned[cell] else _TRIANGLE
        else:
            z[:] = -_TETRAHEDRON if turned[cell] else _TETRAHEDRON
        for node in range(rank + 1):
            share[row] = 1 / (1 + z[node, 0] ** 2) if rank == 1 else share_each
            re, im = sums[cell, _RE] / weight, sums[cell, _IM] / weight
            ratio = sums[cell, FREQUENCY] / weight
            real, imaginary, relative = re, im, ratio
            for a in range(3):
                moved[a] = 0.0
                along = 0.0
                for r in range(rank):
                    moved[a] += root[a, r] * z[node, r]
                    along += z[node, r] * inverse[r, a]
                place[row, a] = mean[a] + moved[a]
                real += along * (sums[cell, _RE_TIMES + 2 * a] / weight - mean[a] * re)
                imaginary += along * (sums[cell, _RE_TIMES + 2 * a + 1] / weight - mean[a] * im)
                relative += along * (sums[cell, _FREQUENCY_TIMES + a] / weight - mean[a] * ratio)
            vis[row, 0], vis[row, 1], frequency[row] = real, imaginary, relative
            for a in range(3):
                for b in range(a, 3):
                    pair = _PAIR[a, b]
                    value = sums[cell, _SECOND + pair] / weight - mean[a] * mean[b]
                    for r in range(rank):
                        value += z[node, r] * third[r, pair]
                    second[row, pair] = value - moved[a] * moved[b]
            cell_of[row] = cell
            row += 1
        for a in range(3):
            for b in range(a, 3):
                pair = _PAIR[a, b]
                spread[pair] = sums[cell, _SECOND + pair] / weight - mean[a] * mean[b]
        first = row - rank - 1
        for number in range(len(_QUADRUPLES)):
            lost = _fourth_moment(sums, cell, mean, number) - _symmetric_square(spread, number)
            for r in range(rank):
                lost -= _symmetric_square(third[r], number)
            lost /= 4
            for node in range(first, row):
                lost += share[node] * _symmetric_square(second[node], number) / 2
            for node in range(first, row):
                fourth[node, number] = lost
