"""The page in the documentation is the one that follows from the numbers beside it."""

import re
from pathlib import Path

from uvshear.reproduce.names import PAPER, TARGETS
from uvshear.reproduce.page import page_of
from uvshear.reproduce.reproduced_target import ReproducedTarget

PLACE = Path(__file__).parents[2] / "docs" / "paper"


def _targets() -> list[ReproducedTarget]:
    paths = [PLACE / f"{name}.json" for name in TARGETS]
    return [ReproducedTarget.read(path) for path in paths if path.exists()]


def test_the_page_has_the_numbers_of_its_records():
    targets = _targets()
    assert targets
    assert (PLACE / "index.md").read_text(encoding="utf-8") == page_of(targets)


def test_the_targets_were_run_at_the_scale_of_the_paper_and_have_their_pictures():
    for target in _targets():
        assert target.scale == PAPER
        assert re.fullmatch("[0-9a-f]{10}", target.commit)
        assert (PLACE / target.picture).exists()
