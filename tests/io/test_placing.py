"""Renames to final names, with the calls of Linux and without them."""

import ctypes
import errno
import os
import threading
import time
from pathlib import Path

import pytest

from tests.cli.processes import wait_for
from uvshear.io import placing
from uvshear.io.placing import one_at_a_time, place_new, replace


@pytest.fixture(params=["renameat2", "links", "neither"])
def system(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out what other systems and file systems lack."""

    def without(*arguments: object) -> None:
        raise NotImplementedError

    def no_links(*arguments: object) -> None:
        raise OSError(errno.EPERM, os.strerror(errno.EPERM))

    if request.param != "renameat2":
        monkeypatch.setattr(placing, "_rename", without)
    if request.param == "neither":
        monkeypatch.setattr(os, "link", no_links)


def _make(path: Path, content: str, *, is_directory: bool) -> Path:
    if is_directory:
        path.mkdir()
        (path / "table.dat").write_text(content)
    else:
        path.write_text(content)
    return path


def _content(path: Path) -> str:
    return (path / "table.dat" if path.is_dir() else path).read_text()


@pytest.mark.usefixtures("system")
@pytest.mark.parametrize("is_directory", [False, True])
def test_a_new_name_is_taken(tmp_path: Path, is_directory: bool) -> None:
    place_new(_make(tmp_path / "new", "new", is_directory=is_directory), tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert _content(tmp_path / "out") == "new"


@pytest.mark.usefixtures("system")
@pytest.mark.parametrize("is_directory", [False, True])
@pytest.mark.parametrize("is_link", [False, True])
def test_a_name_that_exists_is_not_taken(tmp_path: Path, is_directory: bool, is_link: bool) -> None:
    new = _make(tmp_path / "new", "new", is_directory=is_directory)
    if is_link:
        (tmp_path / "out").symlink_to("nowhere")
    else:
        (tmp_path / "out").write_text("old")
    with pytest.raises(FileExistsError):
        place_new(new, tmp_path / "out")
    assert _content(new) == "new"
    assert is_link or _content(tmp_path / "out") == "old"


@pytest.mark.usefixtures("system")
@pytest.mark.parametrize("is_directory", [False, True])
@pytest.mark.parametrize("exists", [False, True])
def test_what_has_the_name_is_replaced(tmp_path: Path, is_directory: bool, exists: bool) -> None:
    private = tmp_path / "private"
    private.mkdir()
    if exists:
        _make(tmp_path / "out", "old", is_directory=is_directory)
    replace(_make(private / "out", "new", is_directory=is_directory), tmp_path / "out")
    assert _content(tmp_path / "out") == "new"
    assert {path.name for path in tmp_path.iterdir()} == {"out", "private"}


def test_the_name_of_a_directory_is_taken_throughout_its_replacement(tmp_path: Path) -> None:
    if not hasattr(ctypes.CDLL(None), "renameat2"):
        pytest.skip("this system cannot exchange two names")
    out, seen = tmp_path / "out", []
    _make(out, "old", is_directory=True)
    ends = threading.Event()

    def look() -> None:
        while not ends.is_set():
            seen.append((out / "table.dat").exists())

    watcher = threading.Thread(target=look)
    watcher.start()
    for number in range(50):
        private = tmp_path / f"{number}"
        private.mkdir()
        replace(_make(private / "out", "new", is_directory=True), out)
        # A busy machine may not let the other thread look as often.
        wait_for(lambda least=number: len(seen) > least)
    ends.set()
    watcher.join()
    assert len(seen) > 50
    assert all(seen)


def test_renames_in_a_directory_wait_for_one_another(tmp_path: Path) -> None:
    order = []

    def other() -> None:
        with one_at_a_time(tmp_path):
            order.append("other")

    with one_at_a_time(tmp_path):
        thread = threading.Thread(target=other)
        thread.start()
        time.sleep(0.1)
        order.append("this")
    thread.join()
    assert order == ["this", "other"]


def test_a_lock_that_is_never_released_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(placing, "_PATIENCE", 0.05)
    with one_at_a_time(tmp_path), one_at_a_time(tmp_path):
        pass
