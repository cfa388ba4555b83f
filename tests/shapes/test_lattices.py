import numpy as np
import pytest
from scipy.spatial import KDTree

from uvshear.shapes.lattices import hexagonal_lattice, shape_lattice


@pytest.mark.parametrize("radius", [0.3, 1.0, 4.2])
def test_the_points_of_a_hexagonal_lattice_are_one_spacing_apart(radius):
    points = hexagonal_lattice(radius, 0.5)
    assert np.hypot(*points.T).max() <= radius * (1 + 1e-9)
    assert np.hypot(*points.T).min() == 0
    if len(points) > 1:
        distance, _ = KDTree(points).query(points, k=2)
        np.testing.assert_allclose(distance[:, 1], 0.5)


def test_no_place_is_farther_from_the_lattice_than_its_spacing_allows():
    places = np.random.default_rng(1).uniform(-2, 2, (2000, 2))
    distance, _ = KDTree(hexagonal_lattice(4.0, 0.5)).query(places)
    assert distance.max() <= 0.5 / np.sqrt(3) * (1 + 1e-9)


def test_shapes_have_all_directions_and_three_sizes():
    e, deviation = shape_lattice()
    assert len(e) == len(deviation) == 39
    assert len(np.unique(np.round(e, 9))) == 13
    assert abs(e.mean()) < 1e-12
    assert set(deviation.tolist()) == {-1.0, 0.0, 1.0}
