"""The longest baseline by the positions of the antennas."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, edited, emptied, simulated, written
from uvshear.io.measurement_set.antennas import read_antennas
from uvshear.io.measurement_set.array_size import array_size
from uvshear.io.measurement_set.observation import MeasurementSet


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _longest(path):
    with tables.table(str(path), ack=False) as main:
        return array_size(main, read_antennas(path)).longest_baseline


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


def _wrong_ratio(path):
    with tables.table(str(path), ack=False) as main:
        return array_size(main, read_antennas(path)).wrong_ratio


def test_baselines_that_are_not_the_distances_of_the_antennas_are_told(path):
    assert _wrong_ratio(path) is None
    with edited(path) as main:
        main.putcol("UVW", 3 * main.getcol("UVW"))
    assert _wrong_ratio(path) == pytest.approx(3, rel=1e-3)
    (notice,) = MeasurementSet(path).notices()
    assert notice.startswith(
        "UVW and the positions of the antennas disagree: the length of UVW is 3 times"
    )


@pytest.mark.parametrize("value", [0.0, np.nan, np.random.default_rng(1).normal(size=(8, 3))])
def test_positions_that_are_not_on_the_earth_tell_nothing(path, value):
    change(path, "POSITION", value, subtable="ANTENNA")
    assert _wrong_ratio(path) is None
