"""The time that rows were averaged over: EXPOSURE, or INTERVAL."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, written
from uvshear.io.measurement_set.observation import MeasurementSet


def _intervals(path):
    data = MeasurementSet(path)
    values = np.concatenate([seen.integrations.interval for seen in data.chunks()])
    return np.unique(values).tolist(), data.notices()


def test_exposure_is_taken(tmp_path):
    path = written(tmp_path, is_averaged=True)
    change(path, "EXPOSURE", 40.0)
    assert _intervals(path) == ([40.0], ())


def test_an_exposure_of_zero_beside_averaged_channels_was_not_filled(tmp_path):
    path = written(tmp_path, is_averaged=True)
    change(path, "EXPOSURE", 0.0)
    values, (told,) = _intervals(path)
    assert values == [60.0]
    assert "EXPOSURE is 0 although the channels are averages" in told
    change(path, "EXPOSURE", 40.0, rows=slice(0, 3))
    assert _intervals(path)[0] == [40.0, 60.0]


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
def test_an_exposure_that_is_none_is_an_interval_where_samples_are_averages(tmp_path, value):
    path = written(tmp_path, is_averaged=True)
    change(path, "EXPOSURE", 40.0)
    change(path, "EXPOSURE", value, rows=slice(3, 5))
    assert _intervals(path)[0] == [40.0, 60.0]


def test_samples_that_are_no_averages_have_no_exposure(tmp_path):
    assert _intervals(written(tmp_path)) == ([0.0], ())


def _without(path, target, columns):
    """Copy a set without some columns, which its storage managers share with others."""
    with tables.table(str(path), ack=False) as main:
        names = [name for name in main.colnames() if name not in columns]
        main.select(",".join(names)).copy(str(target), deep=True, valuecopy=True).close()
    return target


@pytest.mark.parametrize("is_averaged", [True, False])
def test_a_set_may_lack_exposure(tmp_path, is_averaged):
    path = _without(written(tmp_path, is_averaged=is_averaged), tmp_path / "less.ms", ["EXPOSURE"])
    told = "there is no column EXPOSURE; visibilities are taken to be averages over INTERVAL"
    assert _intervals(path) == ([60.0], (told,))


UNKNOWN = "no row has an EXPOSURE or an INTERVAL; smearing in time is not in the model"


@pytest.mark.parametrize("removed", [["INTERVAL"], ["EXPOSURE", "INTERVAL"]])
def test_averages_of_unknown_duration_are_told_of(tmp_path, removed):
    path = written(tmp_path, is_averaged=True)
    change(path, "EXPOSURE", 0.0)
    values, (told,) = _intervals(_without(path, tmp_path / "less.ms", removed))
    assert values == [0.0]
    assert UNKNOWN in told


def test_an_interval_of_zero_is_no_duration(tmp_path):
    """pyuvdata writes both columns with the EXPOSURE that it has read."""
    path = written(tmp_path, is_averaged=True)
    for column in ("EXPOSURE", "INTERVAL"):
        change(path, column, 0.0)
    values, (told,) = _intervals(path)
    assert values == [0.0]
    assert UNKNOWN in told


def test_an_exposure_that_is_longer_than_the_interval_is_told(tmp_path):
    path = written(tmp_path, is_averaged=True)
    change(path, "EXPOSURE", 60.3)
    assert _intervals(path) == ([60.3], ())
    change(path, "EXPOSURE", 90.0)
    values, (told,) = _intervals(path)
    assert values == [90.0]
    assert told.startswith("EXPOSURE is longer than INTERVAL in 1680 rows")
    change(path, "EXPOSURE", 60.0, rows=slice(1, None))
    assert _intervals(path)[1][0].startswith("EXPOSURE is longer than INTERVAL in 1 rows")
