"""Every column of the sums, for cells of a single sample."""

import numpy as np
import pytest

from uvshear.averaging import cell_sums as columns
from uvshear.averaging import kernels
from uvshear.interferometer.averaged_rows import FOURTH


@pytest.mark.parametrize("sign", [1, -1])
def test_the_kernel_fills_the_columns_that_are_named(sign) -> None:
    sums, keys, places = np.empty((4, columns.COLUMNS)), np.empty(4, int), np.full(8, -1, np.int32)
    place, middle, size = np.array([0.2, -0.3, 0.4]), np.array([5, 7, -2]), np.array([10.0, 100.0])
    uvw = (place + middle) * size[[0, 0, 1]]
    _, count = kernels.add_samples(
        0,
        np.array([0]),
        sign * uvw[None] / 1.03,
        np.array([[1234.0, 8.0]]),
        np.array([[1 + 2j * sign]], np.complex64),
        np.array([[3.0]], np.float32),
        np.array([0]),
        np.array([1.03]),
        np.array([0.004]),
        size,
        places,
        keys,
        sums,
        0,
    )
    assert count == 1
    indices = np.empty((1, 3))
    kernels.cell_indices(keys[:1], indices)
    np.testing.assert_array_equal(indices[0], middle)
    found = sums[0] / 3
    assert found[columns.WEIGHT] == 1
    np.testing.assert_allclose(found[columns.VISIBILITY], [1, 2], rtol=1e-6)
    np.testing.assert_allclose(
        found[columns.VISIBILITY_TIMES], np.outer(place, [1, 2]).ravel(), rtol=1e-6
    )
    np.testing.assert_allclose(found[columns.PLACE], place, rtol=1e-9)
    pairs = [place[a] * place[b] for a in range(3) for b in range(a, 3)]
    np.testing.assert_allclose(found[columns.SECOND], pairs, rtol=1e-9)
    triples = [
        place[a] * place[b] * place[c] for a in range(3) for b in range(a, 3) for c in range(b, 3)
    ]
    np.testing.assert_allclose(found[columns.THIRD], triples, rtol=1e-9)
    quadruples = [np.prod(place[list(four)]) for four in FOURTH]
    np.testing.assert_allclose(found[columns.FOURTH], quadruples, rtol=1e-9)
    assert found[columns.FREQUENCY] == pytest.approx(1.03)
    np.testing.assert_allclose(found[columns.FREQUENCY_TIMES], 1.03 * place, rtol=1e-9)
    assert found[columns.RELATIVE_WIDTH] == pytest.approx(0.004)
    assert found[columns.TIME] == pytest.approx(1234)
    assert found[columns.INTERVAL] == pytest.approx(8)
