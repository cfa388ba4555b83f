"""Subtables of a Measurement Set that is written."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import PHASE_CENTRE, simulated, written


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return written(tmp_path_factory.mktemp("written"))


def _column(path, subtable, name):
    with tables.table(str(path / subtable), ack=False) as table:
        return table.getcol(name)


def test_antennas_are_those_of_the_layout(path):
    layout = simulated().coverage.layout
    np.testing.assert_array_equal(_column(path, "ANTENNA", "POSITION"), layout.positions)
    np.testing.assert_array_equal(_column(path, "ANTENNA", "DISH_DIAMETER"), layout.diameters)
    assert tuple(_column(path, "ANTENNA", "NAME")) == layout.antenna_names


def test_all_directions_are_the_phase_centre(path):
    for name in ("PHASE_DIR", "DELAY_DIR", "REFERENCE_DIR"):
        direction = np.ravel(_column(path, "FIELD", name))
        np.testing.assert_array_equal(direction, [PHASE_CENTRE.ra, PHASE_CENTRE.dec])
    assert _column(path, "POINTING", "DIRECTION").shape == (8, 1, 2)


def test_channels_are_those_of_the_band(path):
    channels = simulated().channels
    frequency = _column(path, "SPECTRAL_WINDOW", "CHAN_FREQ")[0]
    np.testing.assert_array_equal(frequency, channels.frequency)
    assert _column(path, "SPECTRAL_WINDOW", "TOTAL_BANDWIDTH")[0] == pytest.approx(
        channels.width.sum()
    )
    assert not _column(path, "SPECTRAL_WINDOW", "EFFECTIVE_BW").any()  # not averaged


def test_the_history_tells_how_the_set_was_made(path):
    (message,) = _column(path, "HISTORY", "MESSAGE")
    assert message.startswith("2 galaxies, CorrelationNoise")
    assert "noise seed 1" in message


def test_nothing_is_flagged_by_command(path):
    with tables.table(str(path / "FLAG_CMD"), ack=False) as table:
        assert table.nrows() == 0
