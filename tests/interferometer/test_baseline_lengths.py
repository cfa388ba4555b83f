"""The extent of an array from UVW and the positions of its antennas."""

import numpy as np
import pytest

from uvshear.interferometer.array_extent import ArrayExtent
from uvshear.interferometer.baseline_lengths import array_extent

POSITIONS = np.array([[6.4e6, 0, 0], [6.4e6, 300, 0], [6.4e6, 0, 400.0]])
DIAMETERS = np.array([12.0, 25.0, 12.0])
PAIRS = np.array([[0, 1], [0, 2], [1, 2]])
UVW = np.array([[0, 300.0, 0], [0, 0, 400.0], [0, 300.0, -400.0]])


def test_it_is_the_largest_distance_with_one_per_cent_and_one_dish():
    assert array_extent(POSITIONS, DIAMETERS, PAIRS, UVW).longest_baseline == pytest.approx(
        1.01 * 500 + 25
    )


def test_antennas_that_nobody_knows_do_not_matter():
    pairs = np.vstack([PAIRS, [[0, 9], [-1, 2]]])
    uvw = np.vstack([UVW, np.zeros((2, 3))])
    positions = np.vstack([POSITIONS, [[np.nan] * 3, [0.0] * 3]])
    expected = pytest.approx(1.01 * 500 + 25)
    assert (
        array_extent(positions, np.append(DIAMETERS, [1e9, 0.0]), pairs, uvw).longest_baseline
        == expected
    )


@pytest.mark.parametrize(
    ("positions", "uvw"),
    [
        (POSITIONS[:1], UVW),
        (POSITIONS, 1.02 * UVW),
        (POSITIONS * np.nan, UVW),
        (POSITIONS, np.full((3, 3), np.nan)),
    ],
)
def test_positions_that_do_not_explain_the_baselines_give_no_limit(positions, uvw):
    assert array_extent(positions, DIAMETERS[: len(positions)], PAIRS, uvw).longest_baseline is None


def test_without_baselines_there_is_no_limit():
    assert array_extent(POSITIONS, DIAMETERS, PAIRS[:0], UVW[:0]) == ArrayExtent()


def test_without_diameters_the_margin_is_that_of_a_usual_dish():
    extent = array_extent(POSITIONS, np.zeros(3), PAIRS, UVW)
    assert extent.margin == 25.0
    assert array_extent(POSITIONS, 12 + 0 * DIAMETERS, PAIRS, UVW).margin == 12.0
