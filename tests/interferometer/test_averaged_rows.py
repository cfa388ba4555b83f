"""What averaged rows say of their samples."""

import numpy as np

from uvshear.interferometer.averaged_rows import MOMENTS, AveragedRows


def test_rows_are_chosen_together() -> None:
    rows = AveragedRows(np.arange(4.0), np.arange(4.0) * 2, np.arange(24.0).reshape(4, 6))
    found = rows.select(np.array([False, True, False, True]))
    np.testing.assert_array_equal(found.frequency, [1, 3])
    np.testing.assert_array_equal(found.width, [2, 6])
    np.testing.assert_array_equal(found.covariance, rows.covariance[[1, 3]])


def test_the_moments_are_the_upper_triangle() -> None:
    assert np.array_equal(np.array(MOMENTS).T, np.triu_indices(3))
