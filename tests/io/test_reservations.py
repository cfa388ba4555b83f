"""Outputs that a process has reserved: a second process is refused before its work."""

import subprocess
import sys
from pathlib import Path

import pytest

from uvshear.errors import InputError
from uvshear.io.outputs import new_file
from uvshear.io.reservations import is_reserved, reserved

HOLDER = """
import sys, time
from pathlib import Path
from uvshear.io.reservations import reserved
with reserved([Path(name) for name in sys.argv[1:]]):
    print("reserved", flush=True)
    time.sleep(600)
"""


def test_an_output_at_which_another_process_is_at_work_is_refused(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    mine = [tmp_path / "a.fits", tmp_path / "a.stats.fits", tmp_path / "sub" / "b.png"]
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, *map(str, mine)], stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    holder.stdout.readline()
    try:
        for path in mine:
            with pytest.raises(InputError, match=rf"{path.name}: another process is at work on it"):
                reserved([path]).__enter__()
        with reserved([tmp_path / "b.png"]):
            pass
    finally:
        holder.kill()
        holder.communicate()
    with reserved(mine):  # a process that was killed holds nothing
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["sub"]
    assert list((tmp_path / "sub").iterdir()) == []


def test_a_reserved_output_that_appears_meanwhile_is_kept_beside_the_new_one(
    tmp_path: Path,
) -> None:
    path = tmp_path / "out.fits"
    with reserved([path]):
        assert is_reserved(tmp_path / "." / "out.fits")
        path.write_text("theirs")
        with pytest.raises(InputError, match="exists now"), new_file(path) as temporary:
            temporary.write_text("ours")
    assert not is_reserved(path)
    assert path.read_text() == "theirs"
    assert [file.read_text() for file in tmp_path.glob("out.fits.kept-*/out.fits")] == ["ours"]
