"""The longest baseline by the positions of the antennas."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, emptied, simulated, written
from uvshear.io.measurement_set.array_size import longest_baseline


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _longest(path):
    with tables.table(str(path), ack=False) as main:
        return longest_baseline(path, main)


def test_it_is_that_of_the_array_with_a_margin(path):
    positions = simulated().coverage.layout.positions
    apart = max(np.linalg.norm(positions - place, axis=1).max() for place in positions)
    assert 1.01 * apart <= _longest(path) <= 1.01 * apart + 15


def test_some_wrong_rows_do_not_matter(path):
    expected = _longest(path)
    change(path, "UVW", 1e7, rows=slice(0, 800))
    change(path, "UVW", np.nan, rows=slice(800, 810))
    change(path, "ANTENNA1", 99, rows=slice(820, 830))
    assert _longest(path) == expected


def test_an_antenna_without_a_position_does_not_matter(path):
    with tables.table(str(path / "ANTENNA"), readonly=False, ack=False) as table:
        table.addrows(1)
        table.putcell("POSITION", 8, np.zeros(3))
    assert _longest(path) < 1e5


@pytest.mark.parametrize("value", [0.0, np.nan, np.random.default_rng(1).normal(size=(8, 3))])
def test_positions_that_do_not_fit_the_baselines_are_not_believed(path, value):
    change(path, "POSITION", value, subtable="ANTENNA")
    assert _longest(path) is None


def test_a_set_without_antennas_has_no_limit(path):
    emptied(path, "ANTENNA")
    assert _longest(path) is None
