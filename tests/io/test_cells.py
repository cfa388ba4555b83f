"""Cells of columns of any type."""

import re

import numpy as np
import pytest
from astropy.coordinates import SkyCoord
from astropy.table import Column, MaskedColumn, Table
from astropy.time import Time

from uvshear.errors import InputError
from uvshear.io.cells import cells_of


@pytest.mark.parametrize(
    ("column", "kind", "values"),
    [
        (Column([1, 2]), "i", [1, 2]),
        (Column(np.array([1, 2], ">f4")), "f", [1.0, 2.0]),
        (MaskedColumn([1.0, 2.0], mask=[True, False]), "f", [None, 2.0]),
        (Column([" a", "b "]), "U", ["a", "b"]),
        (Column([b"a", b"\xe2\x88\x921"]), "U", ["a", "\u22121"]),
        (Column(["a", ""]), "U", ["a", None]),
        (Column(np.array(["a", "long text"], object)), "U", ["a", "long text"]),
        (Column(np.array([b"a", None], object)), "U", ["a", None]),
        (Column(np.array([1, 2.5, None], object)), "f", [1.0, 2.5, None]),
        (MaskedColumn(np.array(["a", "b"], object), mask=[False, True]), "U", ["a", None]),
    ],
)
def test_numbers_and_texts_of_any_type_are_read(column, kind, values):
    cells = cells_of(column)
    assert cells.dtype.kind == kind
    assert cells.tolist() == values


@pytest.mark.parametrize(
    ("column", "message"),
    [
        (Column(np.zeros((2, 3))), "holds arrays"),
        (Column(np.array([np.zeros(2), np.zeros(3)], object)), "holds arrays"),
        (Column([True, False]), "holds values of the type bool"),
        (Column([1j, 2]), "holds values of the type complex128"),
        (Column(np.array([{}, {}], object)), "holds objects of the type dict (row 1)"),
        (Column([b"a", b"J\xe9"]), "has the byte 0xe9 in row 2"),
        (Table({"t": Time([50000.0, 50001], format="mjd")})["t"], "of the type Time"),
        (Table({"c": SkyCoord([1, 2], [3, 4], unit="deg")})["c"], "of the type SkyCoord"),
    ],
)
def test_others_are_refused(column, message):
    with pytest.raises(InputError, match=re.escape(message)):
        cells_of(column)
