"""Readers chosen by format, by name or by place."""

import sys
from importlib.metadata import EntryPoint
from types import ModuleType

import pytest

import uvshear.plugins
from tests.interferometer.chunks import observation
from tests.io.measurement_sets import written
from uvshear.errors import InputError
from uvshear.io.measurement_set.reader import MeasurementSetReader
from uvshear.io.readers import READERS, Reader, reader_of
from uvshear.io.reading import Reading


class NumberReader(Reader):
    """Reads a file that holds the seed of a simulation."""

    format = "seed (a file that ends in .seed)"

    def recognises(self, path):
        return path.suffix == ".seed"

    def open(self, path, reading):
        return observation(int(path.read_text(encoding="utf-8")))


@pytest.fixture
def registered(monkeypatch):
    """A reader that an installed package has registered."""
    mine = ModuleType("readers_of_mine")
    mine.NumberReader = NumberReader
    monkeypatch.setitem(sys.modules, "readers_of_mine", mine)
    point = EntryPoint("seed", "readers_of_mine:NumberReader", "uvshear.readers")
    monkeypatch.setattr(
        uvshear.plugins, "entry_points", lambda group: [point] if group == point.group else []
    )


@pytest.fixture
def seed(tmp_path):
    path = tmp_path / "field.seed"
    path.write_text("1", encoding="utf-8")
    return path


def test_a_measurement_set_is_recognised(tmp_path):
    assert isinstance(reader_of(written(tmp_path), Reading()), MeasurementSetReader)


@pytest.mark.usefixtures("registered")
def test_a_registered_reader_is_chosen_by_format(tmp_path, seed):
    assert READERS.names() == ("measurement-set", "msv4", "seed")
    assert isinstance(reader_of(seed, Reading()), NumberReader)
    assert isinstance(reader_of(written(tmp_path), Reading()), MeasurementSetReader)


@pytest.mark.usefixtures("registered")
@pytest.mark.parametrize(
    "reader",
    ["seed", "readers_of_mine:NumberReader", NumberReader()],
    ids=["registered", "imported", "object"],
)
def test_a_reading_may_name_its_reader(tmp_path, reader):
    assert isinstance(reader_of(tmp_path / "anything", Reading(reader=reader)), NumberReader)


def test_a_file_of_no_known_format_is_refused_in_one_line(seed):
    known = (
        "Measurement Set (a directory that holds table.dat); MSv4 (a directory in the zarr format)"
    )
    with pytest.raises(InputError) as caught:
        reader_of(seed, Reading())
    assert str(caught.value) == (
        f"{seed}: not in a known format of visibilities; the known formats are: {known}"
    )


def test_a_file_that_does_not_exist_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        reader_of(tmp_path / "absent.ms", Reading())


def test_what_is_no_reader_is_refused(seed):
    with pytest.raises(InputError, match="is not a Reader but has the type float"):
        reader_of(seed, Reading(reader="builtins:float"))
