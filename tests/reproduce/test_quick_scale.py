"""All targets at the scale ``quick``, on two cores."""

import json
import time

import pytest

from uvshear.execution import Resources, in_processes
from uvshear.reproduce.names import TARGETS
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.run import reproduce_paper

MINUTES = 20.0


@pytest.mark.long
def test_all_targets_together_take_less_than_twenty_minutes(tmp_path):
    begin = time.monotonic()
    page = reproduce_paper(tmp_path, resources=Resources(in_processes(2))).read_text()
    assert time.monotonic() - begin < 60 * MINUTES
    for target in TARGETS:
        assert f"({target}.png)" in page
        record = json.loads((tmp_path / f"{target}.json").read_text())
        assert record["quantities"]
        printed = PublishedFigures.read(target).values
        shown = [row["paper"] for row in record["quantities"] if row["paper"] is not None]
        assert bool(shown) == bool(printed)
