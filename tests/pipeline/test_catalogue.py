"""A catalogue from any form in which it may be given."""

from dataclasses import replace

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.pipeline.catalogue import catalogue_of


@pytest.fixture
def table():
    return Table(
        {"id": [1, 2], "l": [0.0, 1e-3], "m": [0.0, 2e-3], "flux": [10.0, 20.0] * units.uJy}
    )


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


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("flux", np.nan),
        ("flux", -1.0),
        ("l", 2.0),
        ("m", np.inf),
        ("spectral_index", np.nan),
        ("scale_length", -1.0),
    ],
)
def test_a_catalogue_in_memory_is_checked_as_a_table_is(table, name, value):
    found = catalogue_of(table)
    values = np.zeros(2) if getattr(found, name) is None else getattr(found, name).copy()
    values[1] = value
    with pytest.raises(InputError, match=name):
        catalogue_of(replace(found, **{name: values}))
