"""Columns of averages."""

import pytest
from casacore import tables

from tests.io.measurement_sets import written
from uvshear.io.measurement_set.averaged_columns import (
    FOURTH,
    FREQUENCY,
    SECOND,
    WIDTH,
    has_averages,
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
