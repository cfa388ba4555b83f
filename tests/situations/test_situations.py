"""The table of situations."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from astropy.table import Table

from tests.situations import catalogues, outputs, sets
from tests.situations.situation import Files, Situation

ALL = (*sets.SITUATIONS, *catalogues.SITUATIONS, *outputs.SITUATIONS)


@pytest.mark.parametrize("situation", ALL, ids=lambda situation: situation.name)
def test_a_situation(
    situation: Situation,
    files: Files,
    clean: tuple[Path, Table],
    uvshear: Callable[[list[str]], tuple[int, str]],
) -> None:
    more = situation.make(files)
    words = situation.words.replace("{}", str(files.directory)).split()
    words += more if isinstance(more, list) else []
    status, told = uvshear(words)
    situation.expected.check(status, told, files.directory / "out.fits", clean[1])
    if situation.informs:
        _informed(situation, files, uvshear)


def _informed(
    situation: Situation,
    files: Files,
    uvshear: Callable[[list[str]], tuple[int, str]],
) -> None:
    """``info`` says of a set what ``measure`` says."""
    status, information = uvshear(["info", str(files.field)])
    if situation.expected.refusal is None:
        assert status == 0, information
    else:
        assert status == 2
        assert re.search(situation.expected.refusal, information), information


def test_there_are_sixty_and_their_names_differ() -> None:
    assert len({situation.name for situation in ALL}) == len(ALL) >= 60


def test_patterns_are_specific() -> None:
    patterns = [each.expected.refusal or each.expected.note for each in ALL]
    assert not any(re.search(pattern, "uvshear: error: ") for pattern in patterns if pattern)
