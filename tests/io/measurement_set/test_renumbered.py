"""Whatever a Measurement Set refers to by number may be permuted, renumbered, split, renamed and padded with others."""

import shutil

import numpy as np
import pytest
from casacore import tables
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.io.measurement_sets import edited, written
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.observations import open_observation

REFERENCES = {
    "FIELD": [("", "FIELD_ID")],
    "DATA_DESCRIPTION": [("", "DATA_DESC_ID")],
    "SPECTRAL_WINDOW": [("DATA_DESCRIPTION", "SPECTRAL_WINDOW_ID")],
    "POLARIZATION": [("DATA_DESCRIPTION", "POLARIZATION_ID")],
    "ANTENNA": [("", "ANTENNA1"), ("", "ANTENNA2")],
}
"""The columns that have row numbers of each subtable."""

SPOILT = {
    "FIELD": {"NAME": "another", "PHASE_DIR": np.full((1, 2), np.nan)},
    "DATA_DESCRIPTION": {"SPECTRAL_WINDOW_ID": 99, "POLARIZATION_ID": -1},
    "SPECTRAL_WINDOW": {"CHAN_FREQ": np.zeros(3), "CHAN_WIDTH": np.zeros(2)},
    "POLARIZATION": {"CORR_TYPE": np.array([10, 11], np.int32)},
    "ANTENNA": {"POSITION": np.full(3, np.nan)},
}
"""Cells of rows that nothing refers to."""


def _rearranged(path, subtable, seed, extra):
    """Give a subtable rows in random order, with spoilt rows between them, and change the numbers that refer to it."""
    rng = np.random.default_rng(seed)
    with tables.table(str(path / subtable), ack=False) as old:
        rows = [
            {
                name: old.getcell(name, row)
                for name in old.colnames()
                if old.iscelldefined(name, row)
            }
            for row in range(old.nrows())
        ]
        description = old.getdesc()
    cells = rows + [rows[0] | SPOILT[subtable] for _ in range(extra)]
    order = rng.permutation(len(cells))
    shutil.rmtree(path / subtable)
    with tables.table(str(path / subtable), description, nrow=len(cells), ack=False) as new:
        for place, number in enumerate(order):
            for name, value in cells[number].items():
                new.putcell(name, place, value)
    places = np.argsort(order)
    for other, column in REFERENCES[subtable]:
        with edited(path, other) as table:
            numbers = table.getcol(column)
            inside = (numbers >= 0) & (numbers < len(rows))
            table.putcol(column, np.where(inside, places[np.where(inside, numbers, 0)], numbers))


def _seen(observation):
    """Every sample with its baseline and frequency, in one order, whatever the order of rows."""
    rows = []
    for seen in observation.chunks():
        order = np.argsort(seen.frequency)
        for k in range(len(seen)):
            rows.append((*seen.uvw[k], *seen.stokes_i[k, order], *seen.weights[k, order]))
    return np.array(sorted(rows, key=lambda row: (row[0], row[1], row[2])))


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    path = written(tmp_path_factory.mktemp("original"))
    return path, _seen(MeasurementSet(path))


@settings(
    deadline=None, max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    seed=st.integers(0, 2**31),
    extra=st.dictionaries(st.sampled_from(sorted(REFERENCES)), st.integers(0, 3), min_size=1),
)
def test_numbers_do_not_matter(original, tmp_path, seed, extra):
    path, expected = original
    changed = tmp_path / "changed.ms"
    shutil.rmtree(changed, ignore_errors=True)
    shutil.copytree(path, changed)
    for subtable, count in extra.items():
        _rearranged(changed, subtable, seed, count)
    np.testing.assert_array_equal(_seen(MeasurementSet(changed)), expected)


@pytest.mark.parametrize("column", ["TIME", "ANTENNA1"])
def test_a_set_may_be_split(original, tmp_path, column):
    path, expected = original
    with tables.table(str(path), ack=False) as main:
        middle = float(np.median(main.getcol(column)))
        for name, condition in (("low", f"{column} < {middle}"), ("high", f"{column} >= {middle}")):
            main.query(condition).copy(str(tmp_path / f"{name}.ms"), deep=True).close()
    halves = [tmp_path / "high.ms", tmp_path / "low.ms"]
    np.testing.assert_array_equal(_seen(open_observation(halves)), expected)


def test_rows_may_be_in_any_order(original, tmp_path):
    path, expected = original
    with tables.table(str(path), ack=False) as main:
        order = np.random.default_rng(1).permutation(main.nrows())
        main.selectrows(order).copy(str(tmp_path / "shuffled.ms"), deep=True).close()
    np.testing.assert_array_equal(_seen(MeasurementSet(tmp_path / "shuffled.ms")), expected)


@pytest.mark.parametrize("name", ["", "3C 48 ", "Größe", "7", "a" * 300])
def test_a_field_may_have_any_name(original, tmp_path, name):
    path, expected = original
    renamed = tmp_path / "renamed.ms"
    shutil.copytree(path, renamed)
    with edited(renamed, "FIELD") as fields:
        fields.putcell("NAME", 0, name)
    for field in (None, 0, name):
        np.testing.assert_array_equal(_seen(MeasurementSet(renamed, field=field)), expected)
