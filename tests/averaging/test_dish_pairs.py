"""Kinds of pairs of dishes."""

import numpy as np

from uvshear.averaging.dish_pairs import DishPairs
from uvshear.interferometer.averaged_rows import AveragedRows
from uvshear.interferometer.visibilities import Integrations, Visibilities


def _seen(antennas) -> Visibilities:
    rows = len(antennas)
    return Visibilities(
        uvw=np.arange(3.0 * rows).reshape(rows, 3),
        frequency=np.array([1e9]),
        stokes_i=np.arange(rows, dtype=np.complex64)[:, None],
        weights=np.ones((rows, 1), np.float32),
        integrations=Integrations(np.array(antennas), np.zeros(rows), np.zeros(rows)),
        averages=AveragedRows(
            np.arange(1.0 * rows),
            np.zeros(rows),
            np.zeros((rows, 6)),
            np.zeros((rows, 15)),
            np.ones(3),
        ),
    )


def test_rows_are_divided_by_the_dishes_of_their_antennas() -> None:
    (pairs,) = DishPairs.from_diameters([np.array([15.0, 13.5, 15.0, 25.0])])
    antennas = [(0, 2), (0, 1), (2, 1), (1, 0), (3, 1), (0, 3)]
    seen = _seen(antennas)
    parts = pairs.divided(seen)
    assert sum(map(len, parts.values())) == len(seen)
    for number, part in parts.items():
        assert part.averages is not None
        for row, value in enumerate(part.stokes_i[:, 0].real.astype(int).tolist()):
            kinds = sorted(pairs.kind[list(antennas[value])].tolist())
            assert pairs.kinds(number) == tuple(kinds)
            np.testing.assert_array_equal(part.uvw[row], seen.uvw[value])
            assert part.averages.frequency[row] == value
    np.testing.assert_array_equal(pairs.diameters, [13.5, 15.0, 25.0])


def test_dishes_that_are_alike_need_no_division() -> None:
    seen = _seen([(0, 1), (1, 2)])
    (pairs,) = DishPairs.from_diameters([np.full(3, 25.0)])
    (part,) = pairs.divided(seen).values()
    assert part is seen


def test_a_kind_of_pair_has_the_same_number_in_all_arrays() -> None:
    arrays = [np.array([25.0, 15.0]), np.array([13.5, 25.0, 15.0])]
    first, second = DishPairs.from_diameters(arrays)
    np.testing.assert_array_equal(first.kind, [2, 1])
    np.testing.assert_array_equal(second.kind, [0, 2, 1])
    (number,) = first.divided(_seen([(0, 1)]))
    assert set(second.divided(_seen([(1, 2)]))) == {number}
