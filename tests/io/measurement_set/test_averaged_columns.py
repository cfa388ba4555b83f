"""Columns of averages."""

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.measurement_set.averaged_columns import (
    FOURTH,
    FREQUENCY,
    KEYWORD,
    SECOND,
    SHAPES,
    WIDTH,
    cell_size,
    has_averages,
    read_averages,
)


@pytest.mark.parametrize("missing", [FREQUENCY, WIDTH, SECOND, FOURTH])
def test_rows_are_averages_if_all_columns_are_there(tmp_path, missing):
    path = written(tmp_path)
    with tables.table(str(path), readonly=False, ack=False) as main:
        assert not has_averages(main)
        for name in {FREQUENCY, WIDTH, SECOND, FOURTH} - {missing}:
            main.addcols(tables.maketabdesc(tables.makescacoldesc(name, 0.0)))
        assert not has_averages(main)
        main.addcols(tables.maketabdesc(tables.makescacoldesc(missing, 0.0)))
        assert has_averages(main)


@pytest.mark.parametrize(
    ("keyword", "words"),
    [
        (None, "no sizes of cells"),
        ("33", "no sizes of cells"),
        ({"UV": 33.0}, "no sizes of cells"),
        ({"UV": 33.0, "W": "long"}, "no sizes of cells"),
        ({"UV": 33.0, "W": -1.0}, "cells of 33 x -1 wavelengths"),
        ({"UV": np.inf, "W": 1e4}, "cells of inf x 10000 wavelengths"),
    ],
)
def test_cells_without_a_size_are_refused(tmp_path, keyword, words):
    path = written(tmp_path)
    with tables.table(str(path), readonly=False, ack=False) as main:
        if keyword is not None:
            main.putkeyword(KEYWORD, keyword)
        with pytest.raises(InputError, match=words):
            cell_size(main)
        if keyword is not None:
            main.removekeyword(KEYWORD)
        main.putkeyword(KEYWORD, {"UV": 33.0, "W": 1e4})
        assert cell_size(main).tolist() == [33.0, 33.0, 1e4]


@pytest.mark.parametrize(
    ("name", "description"),
    [
        (WIDTH, tables.makescacoldesc(WIDTH, "")),
        (FREQUENCY, tables.makescacoldesc(FREQUENCY, 1)),
        (SECOND, tables.makearrcoldesc(SECOND, 0.0, shape=[5])),
        (FOURTH, tables.makearrcoldesc(FOURTH, 0.0, shape=[3, 5])),
        (FOURTH, tables.makescacoldesc(FOURTH, 0.0)),
    ],
)
def test_columns_of_another_kind_are_refused(tmp_path, name, description):
    path = written(tmp_path)
    right = {
        FREQUENCY: tables.makescacoldesc(FREQUENCY, 0.0),
        WIDTH: tables.makescacoldesc(WIDTH, 0.0),
        SECOND: tables.makearrcoldesc(SECOND, 0.0, shape=[6]),
        FOURTH: tables.makearrcoldesc(FOURTH, 0.0, shape=[15]),
    }
    with tables.table(str(path), readonly=False, ack=False) as main:
        main.putkeyword(KEYWORD, {"UV": 33.0, "W": 1e4})
        for column in (right | {name: description}).values():
            main.addcols(tables.maketabdesc(column))
        for column, shape in SHAPES.items():
            if len(shape) == 1 and column != name:
                main.putcol(column, np.zeros((main.nrows(), *shape)))
        if name in (SECOND, FOURTH) and "shape" in description["desc"]:
            shape = description["desc"]["shape"]
            main.putcol(name, np.zeros((main.nrows(), *shape)))
        with pytest.raises(InputError, match=f"the column {name} has"):
            read_averages(main, 0, main.nrows(), 1e9)
