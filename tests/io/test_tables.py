"""Tables in files."""

import bz2
import gzip
import lzma
import re
from pathlib import Path

import numpy as np
import pytest
from astropy import units
from astropy.io import fits
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.tables import WRITERS, Wanted, check_table_name, read_table, write_table

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


@pytest.mark.parametrize(
    "suffix", [".fits", ".ecsv", ".vot", ".csv", ".txt", ".dat", ".tbl", ".tsv", ""]
)
@pytest.mark.parametrize("compression", ["", ".gz", ".bz2", ".xz"])
def test_tables_are_read_under_any_extension_and_compressed(tmp_path, suffix, compression):
    plain = tmp_path / f"plain{suffix}"
    if suffix in WRITERS:
        write_table(plain, TABLE)
    else:
        Table(TABLE).write(
            plain, format="ascii.tab" if suffix == ".tsv" else "ascii.commented_header"
        )
    path = plain
    if compression:
        compress = {".gz": gzip.compress, ".bz2": bz2.compress, ".xz": lzma.compress}[compression]
        path = tmp_path / f"table{suffix}{compression}"
        path.write_bytes(compress(plain.read_bytes()))
    back = read_table(path, "table")
    np.testing.assert_array_equal(back["id"], TABLE["id"])
    np.testing.assert_array_equal(back["flux"], TABLE["flux"])


def _several(tmp_path):
    path = tmp_path / "several.fits"
    extensions = [fits.PrimaryHDU()]
    for name, rows in (("FIRST", 1), ("SECOND", 2)):
        extensions.append(fits.table_to_hdu(Table(TABLE)[:rows]))
        extensions[-1].name = name
    fits.HDUList([extensions[0], fits.ImageHDU(np.zeros((2, 2))), *extensions[1:]]).writeto(path)
    return path


@pytest.mark.parametrize(("choice", "rows"), [("[2]", 1), ("[3]", 2), ("[second]", 2)])
def test_an_extension_is_chosen_by_number_or_name(tmp_path, choice, rows):
    assert len(read_table(Path(f"{_several(tmp_path)}{choice}"), "table")) == rows


def test_an_extension_is_found_by_its_columns(tmp_path):
    path = _several(tmp_path)
    with pytest.raises(InputError, match=re.escape("2 (FIRST) of 1 rows, 3 (SECOND) of 2 rows")):
        read_table(path, Wanted("catalogue", suits=lambda names: "flux" in names))
    with pytest.raises(InputError, match=r"several.fits\[1\]: has no such table"):
        read_table(Path(f"{path}[1]"), "table")


def test_a_text_file_has_no_tables_to_choose_among(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="a text file has only one table"):
        read_table(Path(f"{path}[2]"), "table")


def test_an_image_is_no_table(tmp_path):
    path = tmp_path / "image.fits"
    fits.writeto(path, np.zeros((4, 4)))
    with pytest.raises(InputError, match=r"image\.fits: has no table"):
        read_table(path, "catalogue")


def test_text_that_is_not_ascii_stays_bytes_in_fits(tmp_path):
    path = tmp_path / "latin.fits"
    names = fits.Column("id", "8A", array=np.array([b"J\xe90", b"J1"]))
    good = fits.Column("name", "8A", array=np.array([b"a", b"b  "]))
    fits.BinTableHDU.from_columns([names, good]).writeto(path)
    table = read_table(path, "table")
    assert table["id"].dtype.kind == "S"
    assert table["name"].tolist() == ["a", "b"]


def test_a_header_that_promises_more_than_the_file_has_is_refused(tmp_path):
    path = tmp_path / "table.fits"
    write_table(path, TABLE)
    content = path.read_bytes()
    old = b"NAXIS2  =                    2"
    assert old in content
    path.write_bytes(content.replace(old, b"NAXIS2  =         900000000000"))
    with pytest.raises(InputError, match="cannot be read as a table"):
        read_table(path, "catalogue")
