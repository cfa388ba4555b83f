"""A likelihood on a lattice."""

import numpy as np

from uvshear.estimators.shape_likelihood import ShapeLikelihood


def test_nodes_are_where_the_axes_put_them():
    point = np.array([[0, 0, 0], [1, -1, 2]])
    origin = np.array([0.1, -0.2, np.log(5e-6)])
    axes = np.array([[0.05, 0.01, 0.0], [0.0, 0.04, 0.0], [0.02, 0.0, 0.3]])
    zeros = np.zeros(2)
    likelihood = ShapeLikelihood(point, origin, axes, zeros, zeros, zeros)
    # origin + axes @ point
    np.testing.assert_allclose(likelihood.ellipticity, [0.1 - 0.2j, 0.14 - 0.24j])
    np.testing.assert_allclose(likelihood.log_scale_length - origin[2], [0, 0.62])
