"""Mutated inputs: whatever is in a file, the result is right, or the fault is told.

Each case follows from its seed alone, which the message of a failure names with what was mutated;
``battery.Watched.judged`` repeats it. The cases run in a process that is watched, through the functions of the command
line: casacore ends the process on some damaged tables, which no test could survive.
"""

import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.fuzz.battery import Judged, tally, watched
from tests.fuzz.kinds import KINDS, kind_of
from tests.fuzz.oracle import Verdict

QUICK = range(300)
"""Seeds that every run of the tests tries."""

ALL, BLOCK = range(1_000, 6_000), 250
"""Seeds of the long battery, which worker processes take in blocks."""

MOST_VALID = 0.25
"""Part of the cases that may be other valid inputs: more would mean that the rules for these are too generous."""


def judged(directory: Path, seeds: list[int]) -> list[Judged]:
    with watched(directory / "clean", directory / "room", KINDS) as worker:
        return [worker.judged(kind_of(seed), seed) for seed in seeds]


def assert_told(found: list[Judged]) -> None:
    sys.stdout.write(f"{tally(found)}\n")
    failures = [str(one) for one in found if one.verdict.is_failure]
    assert not failures, "\n".join(failures)
    for kind, count in Counter(one.kind for one in found).items():
        valid = sum(one.kind == kind and one.verdict is Verdict.VALID for one in found)
        # Few cases of a kind say little about the part that is valid.
        assert valid <= MOST_VALID * count + 3, f"{kind}: {valid} of {count} are other valid inputs"


@pytest.mark.parametrize("is_of_sets", [True, False], ids=["sets", "others"])
def test_no_fault_is_silent(tmp_path: Path, is_of_sets: bool) -> None:
    seeds = [seed for seed in QUICK if (kind_of(seed) == "measurement set") == is_of_sets]
    assert_told(judged(tmp_path, seeds))


@pytest.mark.fuzz
@pytest.mark.parametrize("first", range(ALL.start, ALL.stop, BLOCK))
def test_no_fault_of_thousands_is_silent(tmp_path: Path, first: int) -> None:
    assert_told(judged(tmp_path, list(range(first, first + BLOCK))))
