"""The choice among several tables."""

import re
from pathlib import Path

import pytest

from uvshear.errors import DataWarning, InputError
from uvshear.io.table_choice import TableEntry, chosen_table, file_and_choice

PATH = Path("lists.fits")
TABLES = [
    TableEntry(1, "ISLANDS", 3, ("ra", "dec")),
    TableEntry(2, "SOURCES", 5, ("ra", "dec", "flux")),
    TableEntry(3, "", 7, ("ra", "dec", "flux", "e1")),
]


def _suits(names):
    return {"ra", "flux"} <= set(names)


def test_a_number_or_a_name_in_brackets_chooses():
    assert file_and_choice(Path("a/b.fits[2]")) == (Path("a/b.fits"), "2")
    assert file_and_choice(Path("b.fits[My list]")) == (Path("b.fits"), "My list")
    assert file_and_choice(Path("b.fits")) == (Path("b.fits"), None)


def test_a_file_whose_name_ends_in_brackets_is_that_file(tmp_path):
    path = tmp_path / "list[2]"
    path.touch()
    assert file_and_choice(path) == (path, None)


@pytest.mark.parametrize(("choice", "rows"), [("1", 3), ("sources", 5), ("3", 7)])
def test_the_table_that_is_asked_for_is_taken(choice, rows):
    assert chosen_table(PATH, TABLES, choice, _suits).rows == rows


def test_the_only_one_that_suits_is_taken_with_a_note():
    with pytest.warns(
        DataWarning,
        match=re.escape("table 2 (SOURCES) is read, because the other 1 of its tables has"),
    ):
        assert chosen_table(PATH, TABLES[:2], None, _suits).number == 2


def test_one_table_needs_no_note():
    assert chosen_table(PATH, TABLES[:1], None, _suits).number == 1


def test_without_a_need_the_first_is_taken():
    assert chosen_table(PATH, TABLES, None, None).number == 1


@pytest.mark.parametrize(
    ("tables", "choice", "message"),
    [
        (
            TABLES,
            None,
            "several tables with positions and fluxes (2 (SOURCES) of 5 rows, 3 of 7 rows); choose one, as in"
            " lists.fits[3]",
        ),
        (TABLES[:1] * 2, None, "none of its 2 tables has positions and fluxes"),
        (
            TABLES,
            "4",
            "lists.fits[4]: has no such table; its tables are 1 (ISLANDS), 2 (SOURCES), 3",
        ),
        ([], None, "has no table"),
    ],
)
def test_a_choice_that_cannot_be_made_is_refused(tables, choice, message):
    with pytest.raises(InputError, match=re.escape(message)):
        chosen_table(PATH, tables, choice, _suits)
