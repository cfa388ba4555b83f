"""Parts of a computation in files of their own."""

from pathlib import Path

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.io import part_files
from uvshear.io.part_files import PartFiles


def test_a_part_is_read_as_it_was_saved(tmp_path):
    parts = PartFiles(tmp_path / "parts", {"version": "1"})
    assert "first" not in parts
    parts.save("first", {"e": np.array([1 + 2j, 3.0]), "n": np.array(3)})
    assert "first" in parts
    found = parts.load("first")
    np.testing.assert_array_equal(found["e"], [1 + 2j, 3.0])
    assert found["n"] == 3
    parts.check()


def test_other_options_are_named(tmp_path):
    PartFiles(tmp_path / "parts", {"version": "1", "seed": "1"}).save("first", {"n": np.ones(1)})
    with pytest.raises(InputError, match="seed was 1 and is 2 now"):
        PartFiles(tmp_path / "parts", {"version": "1", "seed": "2"}).check()


def test_another_directory_is_refused_and_not_removed(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "mine").write_text("mine")
    parts = PartFiles(tmp_path / "parts", {"version": "1"})
    with pytest.raises(InputError, match="something else has it"):
        parts.check()
    parts.remove()
    assert (tmp_path / "parts" / "mine").exists()


def test_parts_are_removed(tmp_path):
    parts = PartFiles(tmp_path / "parts", {"version": "1"})
    parts.save("first", {"n": np.ones(1)})
    parts.remove()
    assert not (tmp_path / "parts").exists()
    parts.check()


def test_a_damaged_part_is_told(tmp_path):
    parts = PartFiles(tmp_path / "parts", {"version": "1"})
    parts.save("first", {"n": np.ones(100)})
    path = tmp_path / "parts" / "first.npz"
    content = bytearray(path.read_bytes())
    content[200] ^= 255
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"first.npz: this part of the computation is damaged"):
        parts.load("first")


def test_nothing_is_left_of_a_removal(tmp_path):
    parts = PartFiles(tmp_path / "parts", {"version": "1"})
    parts.save("first", {"n": np.ones(1)})
    parts.remove()
    parts.save("first", {"n": np.zeros(1)})
    assert parts.load("first")["n"] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"parts"}


def test_a_run_that_ends_while_the_directory_is_made_leaves_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = PartFiles(tmp_path / "parts", {"seed": "1"})

    def end(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(part_files, "write_json", end)
    with pytest.raises(KeyboardInterrupt):
        parts.save("one", {"x": np.zeros(1)})
    monkeypatch.undo()
    assert not parts.directory.exists()
    parts.check()
    parts.save("one", {"x": np.ones(1)})
    assert parts.load("one")["x"].tolist() == [1.0]
    parts.check()
