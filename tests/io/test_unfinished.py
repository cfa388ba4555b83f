"""Private directories of outputs: nobody guesses their names, and none outlives its process for long."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from uvshear.io.unfinished import (
    MARK,
    is_unfinished,
    live_directories,
    release,
    remove_leftovers,
    unfinished_directory,
)

WRITER = """
import sys, time
from pathlib import Path
from uvshear.io.unfinished import unfinished_directory
with unfinished_directory(Path(sys.argv[1]) / "out") as directory:
    (directory / "part").write_text("half")
    (directory / "field.ms").mkdir()
    (directory / "field.ms" / "table.dat").write_text("half")
    print(directory, flush=True)
    time.sleep(600)
"""


def _writer(parent: Path) -> tuple["subprocess.Popen[str]", Path]:
    process = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(parent)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


def _end(process: "subprocess.Popen[str]") -> None:
    process.kill()
    process.communicate()


def test_a_directory_is_private_and_gone_at_the_end(tmp_path: Path) -> None:
    with unfinished_directory(tmp_path / "out.fits") as directory:
        assert directory.parent == tmp_path
        assert directory.stat().st_mode & 0o777 == 0o700
        assert is_unfinished(directory / "a")
        assert not is_unfinished(tmp_path / "a")
    assert list(tmp_path.iterdir()) == []


def test_names_cannot_be_guessed(tmp_path: Path) -> None:
    names = set()
    for _ in range(20):
        with unfinished_directory(tmp_path / "out.fits") as directory:
            names.add(directory.name)
    assert len(names) == 20
    assert all(len(name) >= len(MARK) + 8 for name in names)


def test_the_directory_of_a_living_process_is_left(tmp_path: Path) -> None:
    process, directory = _writer(tmp_path)
    try:
        remove_leftovers(tmp_path)
        assert list(live_directories(tmp_path)) == [directory]
        assert (directory / "part").read_text() == "half"
    finally:
        _end(process)


def test_what_a_killed_process_left_is_removed_by_the_next_output(tmp_path: Path) -> None:
    process, directory = _writer(tmp_path)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert directory.is_dir()
    assert list(live_directories(tmp_path)) == []
    with unfinished_directory(tmp_path / "out.fits"):
        assert not directory.exists()
    assert list(tmp_path.iterdir()) == []


def test_a_leftover_whose_removal_was_cut_short_is_removed(tmp_path: Path) -> None:
    (tmp_path / f".out{MARK}abcd1234" / "sub").mkdir(parents=True)  # without its lock
    remove_leftovers(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_link_in_place_of_a_directory_or_of_its_lock_is_not_followed(tmp_path: Path) -> None:
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "data").write_text("data")
    (tmp_path / f".out{MARK}link").symlink_to("precious")
    trap = tmp_path / f".out{MARK}trap"
    trap.mkdir()
    (trap / "lock").symlink_to(precious / "data")
    (trap / "field.ms").symlink_to(precious)
    dangling = tmp_path / f".out{MARK}dangling"
    dangling.mkdir()
    (dangling / "lock").symlink_to(precious / "made")
    remove_leftovers(tmp_path)
    assert [path.name for path in precious.iterdir()] == ["data"]
    assert (precious / "data").read_text() == "data"
    assert (tmp_path / f".out{MARK}link").is_symlink()


def test_the_directory_of_another_user_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    theirs = tmp_path / f".out{MARK}theirs"
    theirs.mkdir()
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    remove_leftovers(tmp_path)
    assert theirs.is_dir()


def test_a_released_directory_stays(tmp_path: Path) -> None:
    with unfinished_directory(tmp_path / "out.fits") as directory:
        (directory / "whole").write_text("whole")
        release(directory, tmp_path / "kept")
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]
    assert [path.name for path in (tmp_path / "kept").iterdir()] == ["whole"]
