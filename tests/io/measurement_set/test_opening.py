"""Tables of a Measurement Set that lie elsewhere, are locked, or have lost the files of their locks."""

import subprocess
import sys

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.measurement_set.opening import open_table

HOLD = """
import sys
from casacore import tables
held = [tables.table(name, readonly=False, ack=False, lockoptions="permanent") for name in sys.argv[1:]]
print("held", flush=True)
sys.stdin.read()
"""
"""Program that locks tables until its input ends."""


@pytest.fixture
def path(tmp_path):
    return written(tmp_path)


def _seen(path):
    return np.concatenate([seen.stokes_i for seen in MeasurementSet(path).chunks()])


def test_a_selection_of_rows_has_the_subtables_of_its_parent(path, tmp_path):
    selection = tmp_path / "selection.ms"
    with tables.table(str(path), ack=False) as table:
        table.query("ANTENNA1 < 3", name=str(selection)).close()
    assert not (selection / "FIELD").exists()
    with tables.table(str(path), ack=False) as table:
        chosen = table.getcol("ANTENNA1") < 3
    np.testing.assert_array_equal(_seen(selection), _seen(path)[chosen])
    assert len(MeasurementSet(selection).dish_diameters()) == 8


def test_tables_that_are_put_together_are_read_as_one(path, tmp_path):
    joined = tmp_path / "joined.ms"
    tables.msconcat([str(path), str(path)], str(joined))
    np.testing.assert_array_equal(_seen(joined), np.tile(_seen(path), (2, 1)))


def test_a_set_that_another_process_has_locked_is_read(path):
    expected = _seen(path)
    names = [str(path), str(path / "FIELD"), str(path / "SPECTRAL_WINDOW"), str(path / "ANTENNA")]
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, *names],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert holder.stdout.readline() == "held\n"
        np.testing.assert_array_equal(_seen(path), expected)
    finally:
        holder.communicate()


def test_a_set_of_ours_needs_no_files_of_locks(path):
    expected, centre = _seen(path), MeasurementSet(path).phase_centre
    for file in path.rglob("table.lock"):
        file.unlink()
    np.testing.assert_array_equal(_seen(path), expected)
    assert MeasurementSet(path).phase_centre == centre


def test_a_subtable_that_is_not_referred_to_is_an_error(path):
    with tables.table(str(path), readonly=False, ack=False) as main:
        main.removekeyword("FIELD")
    with (
        pytest.raises(InputError, match="the FIELD table cannot be read"),
        open_table(path, "FIELD"),
    ):
        pass
