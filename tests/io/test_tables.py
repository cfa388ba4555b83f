"""Tables in files."""

import numpy as np
import pytest
from astropy import units
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.tables import WRITERS, check_table_name, read_table, write_table

TABLE = Table({"id": [1, 2], "flux": [1.0, 2.0] * units.uJy})


@pytest.mark.parametrize("suffix", WRITERS)
def test_every_format_keeps_values_and_units(tmp_path, suffix):
    path = tmp_path / f"table{suffix}"
    write_table(path, Table(TABLE))
    back = read_table(path, "table")
    np.testing.assert_array_equal(back["flux"], TABLE["flux"])
    assert units.Unit(back["flux"].unit) == units.uJy


def test_an_existing_table_is_replaced_only_on_request(tmp_path):
    path = tmp_path / "table.ecsv"
    write_table(path, Table(TABLE))
    with pytest.raises(InputError, match="exists already"):
        write_table(path, Table(TABLE))
    write_table(path, Table(TABLE)[:1], overwrite=True)
    assert len(read_table(path, "table")) == 1


@pytest.mark.parametrize("name", ["table.txt", "table", "table.csv"])
def test_an_extension_without_a_writer_is_refused(tmp_path, name):
    with pytest.raises(InputError, match=r"the format of the table: \.ecsv, \.fits, \.vot"):
        check_table_name(tmp_path / name)


def test_a_file_that_is_no_table_says_what_is_needed(tmp_path):
    path = tmp_path / "table.fits"
    path.write_text("no table", encoding="utf-8")
    with pytest.raises(InputError, match="a catalogue as ECSV, FITS, VOTable or CSV is needed"):
        read_table(path, "catalogue")
    path.write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="is empty; a catalogue is needed"):
        read_table(path, "catalogue")
