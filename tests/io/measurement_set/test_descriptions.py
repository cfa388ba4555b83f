"""Channels and correlations of those rows that a Measurement Set has, and what is refused."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, edited, written
from uvshear.errors import InputError
from uvshear.io.measurement_set.inspection import inspect_measurement_set
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.reading import Reading


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _add_row(path, subtable, **changes):
    with edited(path, subtable) as table:
        row = table.nrows()
        table.addrows(1)
        for name in table.colnames():
            if table.iscelldefined(name, 0):
                table.putcell(name, row, changes.get(name, table.getcell(name, 0)))
        return row


def _crossed(path):
    row = _add_row(path, "POLARIZATION", CORR_TYPE=np.array([10, 11], np.int32))
    _add_row(path, "DATA_DESCRIPTION", POLARIZATION_ID=row)


def _of_zeros(path):
    row = _add_row(path, "SPECTRAL_WINDOW", CHAN_FREQ=np.zeros(4))
    _add_row(path, "DATA_DESCRIPTION", SPECTRAL_WINDOW_ID=row)


def _unfilled(path):
    with edited(path, "SPECTRAL_WINDOW") as table:
        table.addrows(1)
    _add_row(path, "DATA_DESCRIPTION", SPECTRAL_WINDOW_ID=1)


def _dangling(path):
    _add_row(path, "DATA_DESCRIPTION", SPECTRAL_WINDOW_ID=17)


UNUSED = (_crossed, _of_zeros, _unfilled, _dangling)


@pytest.mark.parametrize("spoil", UNUSED)
def test_a_description_without_rows_may_say_what_it_likes(path, spoil):
    before = next(MeasurementSet(path).chunks())
    spoil(path)
    after = next(MeasurementSet(path).chunks())
    np.testing.assert_array_equal(after.stokes_i, before.stokes_i)
    assert len(inspect_measurement_set(path, Reading()).windows) == 1


@pytest.mark.parametrize("spoil", UNUSED)
def test_the_same_description_is_refused_where_rows_have_it(path, spoil):
    spoil(path)
    change(path, "DATA_DESC_ID", 1, rows=slice(0, 50))
    with pytest.raises(InputError, match=r"field\.ms: DATA_DESC_ID 1: ") as caught:
        MeasurementSet(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("missing", "rows"), [(7, 1), (7, 2), (-1, 1)])
def test_rows_without_a_description_are_refused(path, missing, rows):
    for _ in range(rows - 1):
        _add_row(path, "DATA_DESCRIPTION")
    change(path, "DATA_DESC_ID", missing, rows=slice(0, 50))
    with pytest.raises(
        InputError, match=f"DATA_DESC_ID {missing} of the main table has no row in DATA_DESC"
    ):
        MeasurementSet(path)


def test_a_description_may_have_any_number(path):
    before = next(MeasurementSet(path).chunks())
    _crossed(path)
    _add_row(path, "DATA_DESCRIPTION")
    change(path, "DATA_DESC_ID", 2)
    after = next(MeasurementSet(path).chunks())
    np.testing.assert_array_equal(after.stokes_i, before.stokes_i)


def test_widths_of_another_shape_than_frequencies_are_refused(path):
    with edited(path, "SPECTRAL_WINDOW") as table:
        table.putcell("CHAN_WIDTH", 0, np.full(3, 1e6))
    with pytest.raises(InputError, match=r"CHAN_FREQ has shape \(4,\) and CHAN_WIDTH \(3,\)"):
        MeasurementSet(path)


def test_an_effective_bandwidth_of_another_shape_is_not_used(path):
    with edited(path, "SPECTRAL_WINDOW") as table:
        table.putcell("EFFECTIVE_BW", 0, np.full(3, 1e6))
    description = MeasurementSet(path).header.descriptions[0]
    np.testing.assert_array_equal(description.averaged, description.channels.width)


def test_a_description_says_its_correlations(path):
    (description,) = MeasurementSet(path).header.descriptions
    assert (description.types, description.hands, description.correlations) == ((9, 12), (0, 1), 2)
    assert not description.is_averaged


def _notices(path):
    return MeasurementSet(path).notices()


def test_a_hand_that_alone_makes_stokes_i_is_told(path):
    assert _notices(path) == ()
    change(path, "CORR_TYPE", np.array([[9, 10]], np.int32), subtable="POLARIZATION")
    (told,) = _notices(path)
    assert (
        told == "DATA_DESC_ID 0: XX alone is taken as Stokes I, as there is no other parallel hand"
    )


def test_channels_that_overlap_are_told(path):
    with edited(path, "SPECTRAL_WINDOW") as windows:
        frequency = windows.getcell("CHAN_FREQ", 0)
        windows.putcell("CHAN_FREQ", 0, frequency[[0, 2, 1, 3]])
    assert _notices(path) == ()
    with edited(path, "SPECTRAL_WINDOW") as windows:
        frequency[2] = frequency[1] + 1e6
        windows.putcell("CHAN_FREQ", 0, frequency)
    (told,) = _notices(path)
    assert told.startswith("DATA_DESC_ID 0: channels overlap")


def test_a_channel_averaged_over_many_times_its_width_is_told(tmp_path):
    path = written(tmp_path, is_averaged=True)
    width = MeasurementSet(path).header.descriptions[0].channels.width[0]
    change(path, "EFFECTIVE_BW", 2.67 * width, subtable="SPECTRAL_WINDOW")
    assert _notices(path) == ()
    change(path, "EFFECTIVE_BW", 5 * width, subtable="SPECTRAL_WINDOW")
    (told,) = _notices(path)
    assert told == (
        "DATA_DESC_ID 0: channels are averages over more than 4 times their widths, by their effective widths"
    )


@pytest.mark.parametrize(
    ("subtable", "column", "message"),
    [
        ("POLARIZATION", "CORR_TYPE", r"CORR_TYPE is \[nan, nan\]; a list of whole numbers"),
        ("DATA_DESCRIPTION", "POLARIZATION_ID", "POLARIZATION_ID that is no column of whole"),
        ("DATA_DESCRIPTION", "SPECTRAL_WINDOW_ID", "SPECTRAL_WINDOW_ID that is no column of whole"),
    ],
)
def test_numbers_that_are_not_whole_are_refused(path, subtable, column, message):
    with edited(path, subtable) as table:
        table.renamecol(column, "BEFORE")
        table.addcols(tables.maketabdesc(tables.makearrcoldesc(column, 0.0, ndim=1)))
        table.putcell(column, 0, np.full(2, np.nan))
    with pytest.raises(InputError, match=message):
        MeasurementSet(path)
