"""What averaged rows say of their samples."""

from itertools import product

import numpy as np

from uvshear.interferometer.averaged_rows import FOURTH, SECOND, AveragedRows, permutations_of


def test_rows_are_chosen_together() -> None:
    second, fourth = np.arange(24.0).reshape(4, 6), np.arange(60.0).reshape(4, 15)
    rows = AveragedRows(np.arange(4.0), np.arange(4.0) * 2, second, fourth, np.ones(3))
    found = rows.select(np.array([False, True, False, True]))
    np.testing.assert_array_equal(found.frequency, [1, 3])
    np.testing.assert_array_equal(found.width, [2, 6])
    np.testing.assert_array_equal(found.second, second[[1, 3]])
    np.testing.assert_array_equal(found.fourth, fourth[[1, 3]])


def test_the_moments_are_the_upper_triangle() -> None:
    assert np.array_equal(np.array(SECOND).T, np.triu_indices(3))


def test_coefficients_count_as_often_as_their_coordinates_can_be_ordered() -> None:
    for places in (SECOND, FOURTH):
        every = list(product(range(3), repeat=len(places[0])))
        for place in places:
            assert permutations_of(place) == sum(tuple(sorted(one)) == place for one in every)
        assert sum(map(permutations_of, places)) == len(every)
