"""Known arrays and files of positions."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from astropy.coordinates import EarthLocation

from uvshear.errors import InputError
from uvshear.interferometer.layout import ArrayLayout, known_layouts, load_layout

GOOD = "5109272.1 2006809.2 -3239131.1"
OTHER = "5109284.9 2006824.3 -3239100.2 15 B"


def _file(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "array.txt"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("ska-mid-aa4", 197),
        ("ska-mid-aastar", 144),
        ("ska-mid-aa2", 64),
        ("ska-mid-aa1", 8),
        ("meerkat", 64),
        ("vla-a", 27),
        ("vla-b", 27),
        ("e-merlin", 7),
    ],
)
def test_known_arrays_have_their_dishes(name, count):
    assert len(load_layout(name)) == count


def test_every_known_array_loads_with_its_provenance():
    for name in known_layouts():
        layout = load_layout(name)
        assert layout.name == name
        assert "PyPI" in layout.source


def test_the_first_dishes_of_ska_mid_are_meerkat_s():
    meerkat, full = load_layout("meerkat"), load_layout("ska-mid-aa4")
    assert meerkat.antenna_names == tuple(f"M{index:03d}" for index in range(64))
    assert set(meerkat.diameters) == {13.5}
    np.testing.assert_array_equal(full.positions[:64], meerkat.positions)
    assert set(full.diameters[64:]) == {15.0}


def test_stages_of_ska_mid_contain_one_another():
    stages = [
        set(load_layout(f"ska-mid-{stage}").antenna_names)
        for stage in ("aa1", "aa2", "aastar", "aa4")
    ]
    for smaller, larger in pairwise(stages):
        assert smaller < larger
    assert "SKA001" in stages[0]


@pytest.mark.parametrize("name", ["ska-mid-aa4", "vla-a", "e-merlin"])
def test_latitude_is_astropy_s(name):
    layout = load_layout(name)
    referee = EarthLocation.from_geocentric(*layout.positions.mean(axis=0), unit="m").geodetic
    # measured 3e-13 rad; the geocentric latitude would differ by 3e-3
    assert abs(layout.latitude - referee.lat.rad) < 1e-11
    assert abs(layout.longitude - referee.lon.rad) < 1e-14


def test_a_file_needs_positions_alone(tmp_path):
    layout = load_layout(_file(tmp_path, f"# mine\n{GOOD}  # the core\n\n{OTHER}\n"))
    assert layout.name == "array"
    assert layout.source == "mine"
    assert layout.antenna_names == ("A000", "B")
    assert np.isnan(layout.diameters[0])
    assert layout.diameters[1] == 15
    np.testing.assert_array_equal(layout.positions[0], [5109272.1, 2006809.2, -3239131.1])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{GOOD}\n1 2\n", r"line 2: 2 columns; X Y Z"),
        (f"# c\n\n{GOOD}\n5109284.9 east -3239100.2\n", r"line 4: 'east' is not a number"),
        (f"{GOOD}\n100 200 0\n", r"line 2: the position is .*not East, North, Up"),
        (f"{GOOD}\nnan nan nan\n", r"line 2: the position is nan"),
        (f"{GOOD} -3\n{OTHER}\n", r"line 1: the diameter is -3; 0\.1 to 1000 m are"),
        (f"{GOOD} 1e300\n{OTHER}\n", r"line 1: the diameter is 1e\+300; 0\.1 to 1000 m are"),
        (f"{GOOD}\n{OTHER}\n{GOOD}\n", r"line 3: has the same position as line 1"),
        (f"{GOOD}\n", r"1 antennas; two or more"),
        ("", r"0 antennas; two or more"),
    ],
)
def test_a_wrong_file_is_named_with_its_line(tmp_path, text, message):
    with pytest.raises(InputError, match=message) as caught:
        load_layout(_file(tmp_path, text))
    assert "array.txt" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_mark_of_the_byte_order_is_no_part_of_a_number(tmp_path):
    path = tmp_path / "array.txt"
    path.write_text(f"{GOOD}\n{OTHER}\n", encoding="utf-8-sig")
    assert len(load_layout(path)) == 2


def test_more_antennas_than_anyone_has_are_refused(tmp_path):
    path = tmp_path / "array.txt"
    path.write_text("".join(f"6371000 {k} 0\n" for k in range(10_001)))
    with pytest.raises(InputError, match=r"array\.txt: 10001 antennas; at most 10000"):
        load_layout(path)


def test_a_file_that_is_no_text_is_named(tmp_path):
    path = tmp_path / "array.bin"
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(InputError, match=r"array\.bin: cannot be read as text"):
        load_layout(path)


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(InputError, match=r"vla-z: neither a known array \(ska-mid-aa4, .*e-merlin"):
        load_layout("vla-z")


def test_a_layout_needs_a_name_for_each_antenna():
    with pytest.raises(InputError, match="one name, one position and one diameter"):
        ArrayLayout("x", ("A",), np.zeros((2, 3)), np.ones(2), "")
