"""Tables in plain text."""

import re

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.io.text_tables import read_text

ROWS = [(17.0, -28.0, 10.0), (17.1, -28.1, 20.0), (17.2, -28.2, 30.0)]


def _text(separator, head):
    lines = [head, *(separator.join(map(str, row)) for row in ROWS)]
    return "\n".join(lines) + "\n"


def _check(table):
    assert table.colnames == ["ra", "dec", "flux"]
    for name, values in zip(table.colnames, zip(*ROWS, strict=True), strict=True):
        np.testing.assert_array_equal(table[name], values)


@pytest.mark.parametrize(
    "separator", [",", ", ", ";", " ; ", "\t", "|", " | ", " ", "   "], ids=repr
)
@pytest.mark.parametrize("mark", ["", "#", "# ", "# a table\n# ", "# a table\n\n#"], ids=repr)
def test_separator_and_names_are_found(separator, mark):
    _check(read_text(_text(separator, mark + separator.join(["ra", "dec", "flux"])).encode()))


@pytest.mark.parametrize("separator", [",", ";", "\t", " ", "|"])
def test_text_beyond_ascii_is_read(separator):
    lines = [
        separator.join(row)
        for row in (["name", "\u03b1", "x"], ["\u22123", "1.5", "2"], ["b", "2", "3"])
    ]
    table = read_text("\n".join(lines).encode())
    assert table.colnames == ["name", "\u03b1", "x"]
    assert table["name"].tolist() == ["\u22123", "b"]
    assert table["\u03b1"].tolist() == [1.5, 2.0]
    assert table["x"].tolist() == [2, 3]


@pytest.mark.parametrize(
    "change",
    [
        lambda text: b"\xef\xbb\xbf" + text.encode(),
        lambda text: text.encode("utf-16"),
        lambda text: text.replace("\n", "\r\n").encode(),
        lambda text: text.replace("\n", "\r").encode(),
        lambda text: ("\n\n" + text.replace("\n", "\n\n") + "  \n").encode(),
        lambda text: text.replace("\n17.1", "\n# a remark\n17.1").encode(),
        lambda text: text.rstrip("\n").encode(),
        lambda text: text.replace("ra,dec,flux", '"ra","dec","flux"').encode(),
        lambda text: text.replace("17.0,", '"17.0" ,  ').encode(),
    ],
    ids=[
        "utf-8 mark",
        "utf-16",
        "dos",
        "mac",
        "empty lines",
        "remark",
        "no end",
        "quotes",
        "blanks",
    ],
)
def test_what_editors_do_to_a_file_does_not_change_the_table(change):
    _check(read_text(change(_text(",", "ra,dec,flux"))))


@pytest.mark.parametrize("rule", ["---,---,---", "-----,-,--"])
def test_units_below_the_names_are_read(rule):
    table = read_text(_text(",", f"ra,dec,flux\ndeg,deg,mJy\n{rule}").encode())
    _check(table)
    assert [str(table[name].unit) for name in table.colnames] == ["deg", "deg", "mJy"]


def test_comments_are_metadata():
    table = read_text(_text(" ", "# one\n# two words\n\n# ra dec flux").encode())
    assert table.meta["comments"] == ["one", "two words"]


@pytest.mark.parametrize("word", ["", "null", "NULL", "N/A", "--"])
def test_cells_without_a_value_are_masked(word):
    table = read_text(f"ra,dec\n1.5,2\n{word},3\n4,5\n".encode())
    assert table["ra"].dtype.kind == "f"
    assert table["ra"].mask.tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("cells", "expected"),
    [
        (["1", "2"], [1, 2]),
        (["007", "7"], ["007", "7"]),
        (["1e5", "10e4"], ["1e5", "10e4"]),
        (["+5", "5"], ["+5", "5"]),
        (["20231201123456789012", "1"], ["20231201123456789012", "1"]),
        (["J1 a", "b"], ["J1 a", "b"]),
    ],
)
@pytest.mark.parametrize("separator", [",", "\t", " "])
@pytest.mark.filterwarnings("ignore:OverflowError")
def test_identifiers_stay_as_they_are_written(cells, expected, separator):
    quoted = [f'"{cell}"' if " " in cell else cell for cell in cells]
    lines = [separator.join(["flux", "id"]), *(f"1.5{separator}{cell}" for cell in quoted)]
    table = read_text("\n".join(lines).encode(), texts={"id"})
    assert table["id"].tolist() == expected


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"ra,dec\n1,2\n3,\xe9\n", "line 3 has the byte 0xe9, which is not UTF-8"),
        (b"ra,dec,ra\n1,2,3\n", "two columns are called 'ra'"),
        (b"ra,,flux\n1,2,3\n", "column 2 has no name"),
        (b'id,ra\na,1\n"b,2\nc,3\n"d",4\n', "its 4 lines of data give"),
        (b"1,2,3\n4,5,6\n", "no line has the names of its columns"),
        (b"# a list\n1,2,3\n4,5,6\n", "no line has the names of its columns"),
    ],
)
def test_what_is_wrong_is_said(content, message):
    with pytest.raises(InputError, match=re.escape(message)):
        read_text(content)


def test_rows_of_unequal_length_are_refused():
    with pytest.raises(Exception, match="Number of header columns"):
        read_text(b"ra,dec,flux\n1,2,3\n4,5\n")


def test_ipac_and_ecsv_have_their_own_readers():
    ipac = "\\note = 1\n|  ra  | dec |\n|double|double|\n| deg  | deg |\n|      |     |\n  17.5  -28.0\n"
    table = read_text(ipac.encode())
    assert table["ra"][0] == 17.5
    assert str(table["ra"].unit) == "deg"
    ecsv = (
        "# %ECSV 1.0\n# ---\n# datatype:\n# - {name: ra, unit: deg, datatype: float64}\nra\n17.5\n"
    )
    assert str(read_text(b"\xef\xbb\xbf" + ecsv.encode())["ra"].unit) == "deg"


def test_a_quotation_mark_that_is_not_closed_does_not_swallow_rows():
    ecsv = (
        '# %ECSV 1.0\n# ---\n# datatype:\n# - {name: id, datatype: string}\nid\na\n"b\nc\nd"\ne\n'
    )
    with pytest.raises(InputError, match="its 5 lines of data give 3 rows"):
        read_text(ecsv.encode())
