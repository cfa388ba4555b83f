"""Identifiers that every format can hold."""

import numpy as np
import pytest
from astropy.table import Table

from uvshear.errors import InputError
from uvshear.io.identifiers import check_identifiers
from uvshear.io.tables import read_table, write_table


@pytest.mark.parametrize(
    "names",
    [
        ["J0400-3001", "J0400-3002"],
        ["007", "7"],
        ["a b", "a  b"],
        ['he said "no"', "it's, well"],
        ["1#", "--"],
        ["x" * 300, "y"],
        [2**62, -1],
    ],
)
@pytest.mark.parametrize("suffix", [".fits", ".ecsv", ".vot"])
def test_what_passes_survives_every_format(tmp_path, names, suffix):
    identifier = np.array(names)
    check_identifiers(identifier)
    path = tmp_path / f"table{suffix}"
    write_table(path, Table({"id": identifier, "x": [1.0, 2.0]}))
    assert np.array_equal(np.asarray(read_table(path, "table")["id"]), identifier)


@pytest.mark.parametrize(
    ("name", "character"),
    [("J0400\u22123001", "U+2212"), ("J\xe9", "U+00E9"), ("a\tb", "U+0009"), ("a\nb", "U+000A")],
)
def test_what_fits_cannot_hold_is_refused(name, character):
    with pytest.raises(InputError, match="in row 2 has the character") as caught:
        check_identifiers(np.array(["a", name]))
    assert character in str(caught.value)
    assert str(caught.value).isascii()


def test_what_ecsv_takes_for_a_comment_is_refused():
    with pytest.raises(InputError, match="'#1' in row 2 begins with '#'"):
        check_identifiers(np.array(["a", "#1"]))
