"""A catalogue from any form in which it may be given."""

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.pipeline.catalogue import catalogue_of


@pytest.fixture
def table():
    return Table({"l": [0.0, 1e-3], "m": [0.0, 2e-3], "flux": [10.0, 20.0] * units.uJy})


def test_a_table_a_file_and_a_catalogue_are_taken_alike(table, tmp_path):
    path = tmp_path / "cat.fits"
    table.write(path)
    first = catalogue_of(table)
    assert catalogue_of(first) is first
    for given in (path, str(path)):
        found = catalogue_of(given)
        np.testing.assert_allclose(found.flux, first.flux)
        np.testing.assert_allclose(found.m, first.m)


def test_a_flux_without_a_unit_is_refused(table):
    table["flux"].unit = None
    with pytest.raises(InputError, match="flux"):
        catalogue_of(table)
