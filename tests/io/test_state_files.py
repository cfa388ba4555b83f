"""Files with one object: what is read is what was written, and damage is found."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from uvshear.io.state_files import DamagedError, check_state, read_state, write_state

STATE = {
    "arrays": [np.arange(12.0).reshape(3, 4), np.zeros((0, 3)), np.asfortranarray(np.eye(3))],
    "strided": np.arange(10)[::2],
    "word": "galaxy",
    7: (1j, None),
}


def test_an_object_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "a.state"
    write_state(path, STATE)
    check_state(path)
    found = read_state(path)
    assert found.keys() == STATE.keys()
    for then, now in zip(STATE["arrays"], found["arrays"], strict=True):
        assert np.array_equal(then, now)
        assert now.dtype == then.dtype
        assert now.flags.f_contiguous == then.flags.f_contiguous
    assert np.array_equal(found["strided"], STATE["strided"])
    assert found[7] == (1j, None)
    found["arrays"][0][0] = 5  # it can be written to, and the file stays as it is
    assert read_state(path)["arrays"][0][0, 0] == 0
    assert os.listdir(tmp_path) == ["a.state"]


def test_any_damage_is_found(tmp_path: Path) -> None:
    path = tmp_path / "a.state"
    write_state(path, STATE)
    whole = path.read_bytes()
    assert len(whole) > 500
    for cut in range(0, len(whole), 17):
        path.write_bytes(whole[:cut])
        with pytest.raises(DamagedError):
            check_state(path)
    unnoticed = 0
    for place in range(0, len(whole), 3):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x10]) + whole[place + 1 :])
        try:
            check_state(path)
        except DamagedError:
            continue
        unnoticed += 1
        # Padding between arrays means nothing.
        assert np.array_equal(read_state(path)["arrays"][0], STATE["arrays"][0])
    assert unnoticed < len(whole) / 3 / 4


def test_another_file_is_no_state(tmp_path: Path) -> None:
    path = tmp_path / "a.state"
    path.write_text("id flux\n1 50\n" * 40)
    with pytest.raises(DamagedError):
        read_state(path)


def test_classes_that_are_gone_count_as_damage(tmp_path: Path) -> None:
    """A user's own extraction may have stored objects of a module that has changed since."""
    (tmp_path / "of_the_user.py").write_text("class Own:\n    pass\n")
    path = tmp_path / "a.state"
    code = "import sys; from pathlib import Path; from of_the_user import Own; from uvshear.io.state_files import *; "
    code += "write_state(Path(sys.argv[1]), Own())"
    subprocess.run([sys.executable, "-c", code, path], check=True, cwd=tmp_path)
    check_state(path)
    with pytest.raises(DamagedError, match="of_the_user"):
        read_state(path)


def test_a_state_that_cannot_be_written_leaves_the_earlier_one(tmp_path: Path) -> None:
    path = tmp_path / "a.state"
    write_state(path, 1)
    with pytest.raises(TypeError):
        write_state(path, (i for i in range(3)))  # generators cannot be pickled
    assert read_state(path) == 1
    assert os.listdir(tmp_path) == ["a.state"]
