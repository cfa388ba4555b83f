import json
from collections.abc import Callable
from pathlib import Path

import pytest

from uvshear import __version__


def test_a_target_is_reproduced_and_told(uvshear: Callable, tmp_path: Path) -> None:
    place = tmp_path / "reproduced"
    words = ("reproduce", "psf-images", "--threads", "1", "-o", place)
    outcome = uvshear(*words)
    assert outcome.status == 0, outcome.err
    assert outcome.out == f"the page is {place / 'index.md'}\n"
    record = json.loads((place / "psf-images.json").read_text())
    assert record["command"] == "uvshear reproduce"
    assert record["version"] == __version__
    assert record["options"]["scale"] == "quick"
    first = (place / "index.md").read_text()
    outcome = uvshear(*words)
    assert outcome.status == 0, outcome.err
    assert (place / "index.md").read_text() == first
    outcome = uvshear(*words, "--scale", "paper")
    assert outcome.status == 2
    assert "these parts belong to another computation: scale was quick and is paper" in outcome.err
    assert outcome.err.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["table-9"], "TARGET table-9: is not known; the known targets are psf-images"),
        (["--scale", "huge"], "'huge' is not one of 'quick', 'paper'"),
        (["--seed", "-1"], "--seed"),
    ],
)
def test_a_wrong_call_is_one_line(
    uvshear: Callable, tmp_path: Path, words: list[str], message: str
) -> None:
    place = tmp_path / "reproduced"
    outcome = uvshear("reproduce", *words, "-o", place)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert not place.exists()


def test_a_directory_is_needed(uvshear: Callable, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    outcome = uvshear("reproduce", "psf-images", "-o", tmp_path / "file")
    assert outcome.status == 2
    assert "is a file; a directory is needed" in outcome.err
    assert (tmp_path / "file").read_text() == "mine"
