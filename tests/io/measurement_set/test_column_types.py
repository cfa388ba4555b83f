"""Columns of the wrong type."""

import pytest
from casacore import tables

from tests.io.measurement_sets import edited, written
from uvshear.errors import InputError
from uvshear.io.measurement_set.column_types import OF_ROWS, OF_SAMPLES, check_types
from uvshear.io.measurement_set.observation import MeasurementSet


def test_the_columns_of_a_set_have_their_types(tmp_path):
    path = written(tmp_path)
    with tables.table(str(path), ack=False) as main:
        assert set(OF_ROWS) | set(OF_SAMPLES) <= set(main.colnames())
        check_types(path, main)


@pytest.mark.parametrize("name", sorted({*OF_ROWS, *OF_SAMPLES}))
@pytest.mark.parametrize("ndim", [0, 1])
def test_text_is_refused(tmp_path, name, ndim):
    path = written(tmp_path)
    with edited(path) as main:
        main.renamecol(name, "BEFORE")
        column = (
            tables.makearrcoldesc(name, "", ndim=ndim, valuetype="string")
            if ndim
            else tables.makescacoldesc(name, "", valuetype="string")
        )
        main.addcols(tables.maketabdesc(column))
    with pytest.raises(InputError, match=rf"column {name} holds (one|an array) of type string"):
        MeasurementSet(path)


def test_an_array_in_place_of_a_number_is_refused(tmp_path):
    path = written(tmp_path)
    with edited(path) as main:
        main.renamecol("TIME", "BEFORE")
        main.addcols(tables.maketabdesc(tables.makearrcoldesc("TIME", 0.0, ndim=1)))
    with pytest.raises(
        InputError, match="column TIME holds an array of type double for each row; one"
    ):
        MeasurementSet(path)
