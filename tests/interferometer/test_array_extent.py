"""Lengths that the baselines of an array can have."""

import numpy as np
import pytest

from tests.interferometer.test_baseline_lengths import DIAMETERS, PAIRS, POSITIONS, UVW
from uvshear.interferometer.array_extent import ArrayExtent
from uvshear.interferometer.baseline_lengths import array_extent

EXTENT = array_extent(POSITIONS, DIAMETERS, PAIRS, UVW)


@pytest.mark.parametrize(
    ("scale", "is_allowed"), [(1.0, True), (1.05, True), (0.95, True), (1.1, False), (0.5, False)]
)
def test_each_baseline_has_the_length_between_its_own_antennas(scale, is_allowed):
    # One per cent and the largest dish, 25 m, are 28 to 30 m of 300 to 500 m.
    assert (EXTENT.allows(scale * UVW, PAIRS) == is_allowed).all()
    swapped = EXTENT.allows(UVW[::-1], PAIRS)
    np.testing.assert_array_equal(swapped, [False, True, False])


def test_antennas_whose_places_are_not_known_allow_any_baseline_within_the_array():
    positions = np.vstack([POSITIONS, [[np.nan] * 3, [0.0] * 3]])
    extent = array_extent(positions, np.append(DIAMETERS, [25.0, 25.0]), PAIRS, UVW)
    uvw = np.array([[100.0, 0, 0], [100.0, 0, 0], [100.0, 0, 0], [600.0, 0, 0], [0, 0, 0]])
    pairs = np.array([[0, 3], [4, 1], [0, 9], [0, 3], [-1, 3]])
    np.testing.assert_array_equal(extent.allows(uvw, pairs), [True, True, True, False, False])
    np.testing.assert_array_equal(EXTENT.allows(uvw[:4], None), [True, True, True, False])


def test_distances_that_do_not_explain_the_baselines_forbid_none():
    extent = array_extent(POSITIONS, DIAMETERS, PAIRS, 2 * UVW)
    assert extent.allows(2 * UVW, PAIRS).all()


def test_nothing_is_known_of_an_array_but_the_distance_of_the_moon():
    uvw = np.array([[1e8, 0, 0], [1.1e9, 0, 0], [0, 0, 0], [np.nan, 0, 0], [np.inf, 0, 0]])
    assert ArrayExtent().allows(uvw, np.zeros((5, 2), int)).tolist() == [True, *[False] * 4]
    assert ArrayExtent().notice is None
