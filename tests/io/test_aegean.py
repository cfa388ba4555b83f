"""Component catalogues of Aegean."""

import re

import numpy as np
import pytest
from astropy.table import MaskedColumn, Table

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.io.catalogue import catalogue_from_table
from uvshear.io.source_finders import FWHM_OF_SCALE_LENGTH


def _table(**columns):
    """A round beam of 3 arcsec; a galaxy of 4 x 3 arcsec without it, and one that the beam hides."""
    galaxy = np.hypot([4.0, 3.0], 3.0)
    table = Table(
        {
            "island": [0, 1],
            "source": [0, 0],
            "ra": [52.0, 52.1],
            "dec": [-27.0, -27.1],
            "err_ra": [1e-5, -1.0],
            "err_dec": [1e-5, -1.0],
            "int_flux": [1e-3, 2e-3],
            "err_int_flux": [1e-5, -1.0],
            "a": [galaxy[0], 3.0],
            "b": [galaxy[1], 2.9],
            "pa": [30.0, 0.0],
            "err_a": [0.1, -1.0],
            "err_b": [0.1, -1.0],
            "err_pa": [2.0, -1.0],
            "psf_a": [3.0, 3.0],
            "psf_b": [3.0, 3.0],
            "psf_pa": [0.0, 0.0],
            "uuid": ["one", "two"],
        }
    )
    for name, values in columns.items():
        table[name] = values
    return table


def test_lists_are_recognised_and_deconvolved():
    catalogue = catalogue_from_table(_table())
    assert catalogue.identifier.tolist() == ["one", "two"]
    np.testing.assert_allclose(catalogue.flux, [1e-3, 2e-3])
    np.testing.assert_allclose(catalogue.flux_err, [1e-5, 0.0])
    # What the beam hides is a galaxy of half the beam or less, of unknown error.
    expected = np.array([np.sqrt(12.0), 1.5]) / FWHM_OF_SCALE_LENGTH * ARCSEC
    np.testing.assert_allclose(catalogue.scale_length, expected, rtol=1e-7)
    assert catalogue.is_point is None
    # d ln w = (a da / long^2 + b db / short^2) / 2 for errors along the axes, which are independent
    fit, source = np.hypot([4.0, 3.0], 3.0), np.array([4.0, 3.0])
    relative = 0.5 * 0.1 * np.hypot(*(fit / source**2))
    relative_err = catalogue.scale_length_err / catalogue.scale_length
    np.testing.assert_allclose(relative_err, [relative, np.sqrt(np.e - 1)], rtol=1e-6)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"a": ["big", "small"]}, "column 'a' holds text ('big' for id one)"),
        ({"psf_pa": np.zeros((2, 2))}, "column 'psf_pa' holds arrays"),
        ({"int_flux": ["1e-3", "faint"]}, "column 'int_flux' holds text ('faint' for id two)"),
        ({"int_flux": MaskedColumn([1e-3, 1], mask=[0, 1])}, "'int_flux' has no value for id two"),
        ({"uuid": MaskedColumn(["one", "x"], mask=[0, 1])}, "column 'uuid', row 2: is empty"),
        ({"uuid": ["one", "one"]}, "column 'uuid': one occurs 2 times"),
    ],
)
def test_a_wrong_column_is_named(columns, message):
    with pytest.raises(InputError, match=re.escape(message)):
        catalogue_from_table(_table(**columns), "islands.csv")


@pytest.mark.parametrize("absent", ["a", "pa", "psf_pa"])
def test_without_ellipses_there_are_no_sizes(absent):
    table = _table()
    table.remove_column(absent)
    assert catalogue_from_table(table).scale_length is None


def test_an_ellipse_that_is_missing_is_an_unknown_size():
    columns = {"a": MaskedColumn([5.0, 3.0], mask=[False, True])}
    assert np.isnan(catalogue_from_table(_table(**columns)).scale_length).tolist() == [False, True]
