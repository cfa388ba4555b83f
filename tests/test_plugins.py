"""Objects by name: of the package, of entry points, of the user's own file."""

import math
import sys
from importlib.metadata import EntryPoint

import pytest

import uvshear.plugins
from uvshear.errors import InputError
from uvshear.plugins import Registry

SQUARES = Registry(
    "square",
    "uvshear.squares",
    {"one": "math:sqrt", "gone": "no_such_module:Square", "hollow": "math:no_such_name"},
    {"first": "one"},
)


@pytest.fixture
def registered(monkeypatch):
    points = [
        EntryPoint("zwei", "math:hypot", "uvshear.squares"),
        EntryPoint("drei", "math:pow", "uvshear.squares"),
        EntryPoint("one", "math:pow", "uvshear.squares"),
        EntryPoint("other", "math:pow", "uvshear.circles"),
    ]
    monkeypatch.setattr(
        uvshear.plugins, "entry_points", lambda *, group: [p for p in points if p.group == group]
    )


def test_names_are_the_packages_own_and_then_those_of_entry_points(registered):
    assert SQUARES.names() == ("one", "gone", "hollow", "drei", "zwei")


def test_names_and_aliases_are_found(registered):
    assert SQUARES.find("one") is math.sqrt
    assert SQUARES.find("first") is math.sqrt
    assert SQUARES.find("zwei") is math.hypot


def test_a_file_in_the_current_directory_is_imported(tmp_path, monkeypatch):
    (tmp_path / "my_squares_of_a_test.py").write_text("class Square:\n    side = 3\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    assert SQUARES.find("my_squares_of_a_test:Square").side == 3


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("two", "'two' is not a known square; the known names are one, gone, hollow"),
        ("gone", "the square 'gone' cannot be imported: No module named 'no_such_module'"),
        ("hollow", "the square 'hollow' cannot be imported"),
        ("no_such_module:Square", "cannot be imported: No module named"),
        (":Square", "cannot be imported"),
        ("math:", "cannot be imported"),
    ],
)
def test_what_cannot_be_found_is_told_in_one_line(name, message):
    with pytest.raises(InputError) as error:
        SQUARES.find(name)
    assert message in str(error.value)
    assert "\n" not in str(error.value)
