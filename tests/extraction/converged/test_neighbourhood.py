import numpy as np
import pytest

from uvshear.constants import ARCSEC
from uvshear.extraction.converged.neighbourhood import NEAR, SEPARATION, Neighbourhood

PLACE = np.array([[0.0, 0.0], [8.0, 0.0], [0.0, 12.0], [40.0, 0.0], [500.0, 0.0]]) * ARCSEC
FLUX = np.array([1.0, 3.0, 2.0, 5.0, 4.0])


@pytest.fixture
def sources():
    return Neighbourhood.from_sizes(PLACE, FLUX, np.full(5, 1.5 * ARCSEC))


def test_sources_that_overlap_are_a_unit(sources):
    assert sources.units == [[0, 1], [2], [3], [4]]
    assert sources.is_grouped.tolist() == [True, True, False, False, False]
    assert sources.singles == [[0], [1], [2], [3], [4]]


def test_neighbours_are_given_the_nearest_first(sources):
    assert sources.nearest_to(0) == [1, 2]
    assert sources.nearest_to(4) == []


def test_those_around_a_source_are_itself_and_the_near_ones(sources):
    assert NEAR < 40 * ARCSEC
    assert sources.around(np.array([2])).tolist() == [True, True, True, False, False]
    assert sources.around(np.array([3, 4])).tolist() == [False, False, False, True, True]


def test_units_come_after_all_brighter_ones_near_them(sources):
    assert SEPARATION < 400 * ARCSEC
    levels = list(sources.levels(sources.units))
    assert sorted(levels[0]) == [[3], [4]]
    assert levels[1:] == [[[0, 1]], [[2]]]
    assert list(sources.levels([])) == []
