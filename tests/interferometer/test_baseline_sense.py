"""The sense of stored baselines, compared with those of a simulated track."""

import numpy as np
import pytest

from tests.io.measurement_sets import PHASE_CENTRE, simulated
from uvshear.interferometer.baseline_sense import sense_agrees
from uvshear.interferometer.visibilities import Integrations


@pytest.fixture(scope="module")
def track():
    coverage = simulated().coverage
    rows = np.arange(0, len(coverage), 50)
    antennas = np.column_stack([coverage.antenna1, coverage.antenna2])[rows]
    taken = Integrations(antennas, coverage.time[rows], np.zeros(len(rows)))
    return coverage.uvw[rows], taken, coverage.layout.positions


@pytest.mark.parametrize(("sign", "expected"), [(1, True), (-1, False)])
def test_either_sign_is_recognised(track, sign, expected):
    uvw, taken, positions = track
    assert sense_agrees(sign * uvw, taken, positions, PHASE_CENTRE) is expected


@pytest.mark.parametrize("factor", [0.0, np.nan, np.array([0.0, 0.0, 1e12])])
def test_other_baselines_have_no_sense(track, factor):
    uvw, taken, positions = track
    assert sense_agrees(factor * uvw, taken, positions, PHASE_CENTRE) is None


def test_rows_that_cannot_be_compared_do_not_matter(track):
    uvw, taken, positions = track
    antennas, time = taken.antennas.copy(), taken.time.copy()
    antennas[:10] = 99
    antennas[10:12] = -1
    antennas[12:14] = 3
    time[14] = np.nan
    broken = Integrations(antennas, time, taken.interval)
    assert sense_agrees(uvw, broken, positions, PHASE_CENTRE) is True
    assert sense_agrees(uvw, broken, positions * np.nan, PHASE_CENTRE) is None


def test_no_rows_have_no_sense(track):
    uvw, taken, positions = track
    none = taken.select(np.zeros(len(uvw), bool))
    assert sense_agrees(uvw[:0], none, positions, PHASE_CENTRE) is None
