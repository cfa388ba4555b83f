"""What a user is told of a set that is measured all the same."""

import numpy as np
from casacore import tables

from tests.io.measurement_sets import change, written
from uvshear.io.inspection import inspect


def remarks(path):
    (content,) = inspect(path).fields
    return remarks_on(content)


def test_a_good_set_calls_for_no_remark(tmp_path):
    assert remarks(written(tmp_path)) == ()


def test_what_is_left_out_without_a_flag_is_counted(tmp_path):
    path = written(tmp_path)
    change(path, "DATA", np.nan, rows=[0, 3])
    change(path, "WEIGHT_SPECTRUM", -1.0, rows=[7])
    infinite, weightless = remarks(path)
    assert infinite.startswith(f"{path}: 8 of 6720 visibilities are NaN or infinite")
    assert weightless.startswith(f"{path}: 4 of 6720 visibilities have a weight of zero or less")


def test_the_other_sign_of_uvw_is_told(tmp_path):
    path = written(tmp_path)
    with tables.table(str(path), readonly=False, ack=False) as main:
        main.putcol("UVW", -main.getcol("UVW"))
    (remark,) = remarks(path)
    assert "UVW is X(ANTENNA2) - X(ANTENNA1)" in remark
    assert "used as stored" in remark


def test_weights_from_sigma_are_told(tmp_path):
    path = written(tmp_path)
    for column in ("WEIGHT", "WEIGHT_SPECTRUM"):
        change(path, column, 0.0)
    (remark,) = remarks(path)
    assert remark == f"{path}: no WEIGHT above zero; the weights are 1/SIGMA^2"
