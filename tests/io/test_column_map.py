"""Names of columns that differ from ours."""

import re

import numpy as np
import pytest
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.catalogue import read_catalogue
from uvshear.io.column_map import KNOWN, column_map_of


def test_pairs_are_read_with_blanks_in_names():
    found = column_map_of("ra=RAJ2000, dec = DEJ2000,flux=S 1.4 GHz")
    assert found == {"ra": "RAJ2000", "dec": "DEJ2000", "flux": "S 1.4 GHz"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ra", "'ra' is not a pair such as ra=RAJ2000"),
        ("ra=", "is not a pair"),
        ("ra=A,", "'' is not a pair"),
        ("ra=A,ra=B", "names 'ra' twice"),
        ("RAJ2000=ra", "'RAJ2000' is no column of a catalogue; those are id, ra"),
    ],
)
def test_what_is_no_pair_is_refused(text, message):
    with pytest.raises(InputError, match=re.escape(message)):
        column_map_of(text)


@pytest.fixture
def path(tmp_path):
    table = Table(
        {
            "Name": ["007", "1e3"],
            "RAJ2000": ["04 00 00.0", "04 00 01.0"],
            "DEJ2000": ["-30 00 00", "-30 00 10"],
            "S_1400": [1.0, 2.0],
            "ra": [0.0, 0.0],
        }
    )
    path = tmp_path / "nvss.csv"
    table.write(path, format="ascii.csv")
    return path


def test_a_catalogue_is_read_by_other_names(path):
    pairs = {"id": "Name", "ra": "raj2000", "dec": "DEJ2000", "flux": "S_1400"}
    catalogue = read_catalogue(path, flux_unit="mJy", column_map=pairs)
    assert catalogue.identifier.tolist() == ["007", "1e3"]
    np.testing.assert_allclose(np.degrees(catalogue.ra), [60.0, 60 + 15 / 3600])
    np.testing.assert_allclose(np.degrees(catalogue.dec), [-30.0, -30 - 10 / 3600])
    np.testing.assert_allclose(catalogue.flux, [1e-3, 2e-3])


def test_a_name_that_the_table_lacks_is_refused(path):
    with pytest.raises(
        InputError, match=r"has no column 'S_150', which --column-map .* names for 'flux'"
    ):
        read_catalogue(path, column_map={"flux": "S_150"})


def test_the_map_goes_before_the_columns_of_a_source_finder(tmp_path):
    table = Table(
        {
            "id": [1],
            "RA": [1.0],
            "DEC": [2.0],
            "Total_flux": [3.0],
            "Peak_flux": [4.0],
            "scale_length": [1.0],
        }
    )
    path = tmp_path / "list.csv"
    table.write(path, format="ascii.csv")
    catalogue = read_catalogue(path, flux_unit="Jy", column_map={"flux": "Peak_flux"})
    assert catalogue.flux.tolist() == [4.0]


def test_every_column_of_a_written_catalogue_can_be_mapped():
    from uvshear import Galaxies, catalogue_from_galaxies
    from uvshear.io.catalogue import catalogue_table

    one = np.full(1, 1e-5)
    galaxies = Galaxies(one, one, one, one, one.astype(complex), one)
    assert set(catalogue_table(catalogue_from_galaxies(galaxies)).colnames) <= set(KNOWN)
