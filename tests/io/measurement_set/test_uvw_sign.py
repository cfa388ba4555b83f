"""The sense of the stored baselines."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, real_set, written
from uvshear.io.measurement_set.header import read_header
from uvshear.io.measurement_set.uvw_sign import uvw_sign_agrees


def _agrees(path):
    return uvw_sign_agrees(path, read_header(path, "DATA", None))


def _with_uvw(path, transform):
    with tables.table(str(path), readonly=False, ack=False) as main:
        main.putcol("UVW", transform(main.getcol("UVW")))


def test_a_simulated_set_agrees(tmp_path):
    assert _agrees(written(tmp_path)) is True


def test_rows_without_a_time_or_a_known_antenna_are_not_compared(tmp_path):
    path = written(tmp_path)
    for column, value, rows in (
        ("TIME", np.inf, slice(0, 500)),
        ("ANTENNA1", 99, slice(500, 800)),
        ("ANTENNA2", -1, slice(800, 1000)),
        ("UVW", -np.inf, slice(1000, 1200)),
        ("UVW", 1e300, slice(1200, 1300)),
    ):
        change(path, column, value, rows=rows)
    assert _agrees(path) is True
    change(path, "POSITION", np.inf, subtable="ANTENNA")
    assert _agrees(path) is None
    change(path, "TIME", np.nan)
    assert _agrees(path) is None


def test_reversed_baselines_are_found(tmp_path):
    path = written(tmp_path)
    _with_uvw(path, np.negative)
    assert _agrees(path) is False


@pytest.mark.parametrize("transform", [lambda uvw: 0 * uvw, lambda uvw: uvw[::-1].copy()])
def test_baselines_that_fit_neither_way_are_unclear(tmp_path, transform):
    path = written(tmp_path)
    _with_uvw(path, transform)
    assert _agrees(path) is None


def test_autocorrelations_alone_are_unclear(tmp_path):
    path = written(tmp_path)
    change(path, "ANTENNA1", 0)
    change(path, "ANTENNA2", 0)
    assert _agrees(path) is None


@pytest.mark.real
@pytest.mark.parametrize(
    ("archive", "sense"),
    [
        ("day2_TDEM0003_10s_norx_1src_1spw.ms.tar.gz", True),
        ("tDish.MS.tgz", True),
        ("tOSKAR.in_MS.tgz", False),  # LOFAR's sense: X(ANTENNA2) - X(ANTENNA1)
    ],
)
def test_real_sets_have_a_sense(tmp_path, archive, sense):
    assert _agrees(real_set(tmp_path, archive)) is sense
