import numpy as np

from uvshear.shapes.normal_sums import COUNT, NormalSums

SUMS = NormalSums(np.arange(COUNT, dtype=float))


def test_the_products_with_the_data_come_first():
    np.testing.assert_array_equal(SUMS.products, [0, 1, 2, 3])


def test_the_gram_matrix_is_symmetric_and_its_upper_triangle_runs_by_rows():
    np.testing.assert_array_equal(SUMS.gram, SUMS.gram.T)
    np.testing.assert_array_equal(SUMS.gram[np.triu_indices(4)], np.arange(4, 14))
    assert SUMS.norm == SUMS.gram[0, 0] == 4


def test_gradient_and_curvature_of_the_position_come_last():
    np.testing.assert_array_equal(SUMS.position_gradient, [14, 15])
    np.testing.assert_array_equal(SUMS.position_curvature, [[16, 17], [17, 18]])
