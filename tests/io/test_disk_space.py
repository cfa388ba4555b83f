"""Room on a disk."""

import os
from pathlib import Path

import pytest

from tests.io.measurement_sets import simulated
from uvshear.errors import InputError
from uvshear.io.disk_space import require_space
from uvshear.io.measurement_set.writer import _size, write_measurement_set


def test_what_no_disk_can_hold_is_refused(tmp_path: Path) -> None:
    line = r"field\.ms: needs 1e\+18 MB, but its disk has only .* MB left; make room, or write elsewhere"
    with pytest.raises(InputError, match=line):
        require_space(tmp_path / "field.ms", 1e24)
    require_space(tmp_path / "field.ms", 0)


def test_a_set_is_not_larger_than_the_room_that_is_asked_for(tmp_path: Path) -> None:
    observation = simulated()
    write_measurement_set(tmp_path / "field.ms", observation)
    files = [path for path in (tmp_path / "field.ms").rglob("*") if path.is_file()]
    size = sum(os.stat(path).st_blocks * 512 for path in files)
    # For 20 MB and more it is within a tenth.
    assert size < _size(observation) < size + 2.5e6
