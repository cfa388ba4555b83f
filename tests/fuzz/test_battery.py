"""The battery finds what it is for: commands that crash, hang, fail, or change a result without a word."""

import os
import signal
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.fuzz.battery import Judged, tally, watched
from tests.fuzz.case import Kind, Reading
from tests.fuzz.kinds import KINDS, SHARES, kind_of
from tests.fuzz.oracle import Run, Verdict, difference_of, dishonest, judge
from tests.fuzz.wild import damage

CLEAN = Run(0, "", None, (), 1.0)
ROW = {"flag": "ok", "e1": 0.1, "e1_err": 0.01, "weight": 2.0, "snr": 20.0}


class Faults(Kind):
    """A kind whose mutations end the worker."""

    variants = ("array.txt",)

    def mutate(self, clean: Path, variant: str, path: Path, rng: np.random.Generator) -> str:
        """Tell by a file what the command is to do."""
        path.write_text(("abort", "loop", "same")[int(rng.integers(3))])
        return path.read_text()

    def readings(self, clean: Path, variant: str, path: Path) -> tuple[Reading, ...]:
        """Do it in place of a command."""
        word = path.read_text()
        if word == "abort":
            os.abort()
        if word == "loop":
            # As the limit of a run's processor time does.
            os.kill(os.getpid(), signal.SIGXCPU)
            time.sleep(60)
        return (Reading(("layouts",)),)

    def is_valid(self, clean: Path, variant: str, path: Path) -> bool:
        """Return that nothing is valid."""
        return False


def test_a_worker_that_ends_is_a_verdict_and_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "clean").mkdir()
    (tmp_path / "clean" / "array.txt").write_text("clean")
    words = ("abort", "loop", "same")
    drawn = [words[int(np.random.default_rng([seed]).integers(3))] for seed in range(12)]
    expected = {"abort": Verdict.CRASH, "loop": Verdict.HANG, "same": Verdict.SAME}
    seeds = [drawn.index(word) for word in words]
    with watched(tmp_path / "clean", tmp_path / "room", {"faults": Faults()}) as worker:
        found = [worker.judged("faults", seed).verdict for seed in seeds]
    assert found == [expected[word] for word in words]


def judged_run(**changes: object) -> Verdict:
    return judge(replace(CLEAN, **changes), CLEAN, None, lambda: False)[0]


def test_runs_are_judged_by_their_end() -> None:
    assert judged_run() is Verdict.SAME
    assert judged_run(status=None, err="ValueError: x") is Verdict.TRACEBACK
    assert judged_run(status=2, err="uvshear: error: x") is Verdict.REFUSED
    assert judged_run(status=2, err="uvshear: error: x\nand more") is Verdict.WORDS
    assert judged_run(status=2) is Verdict.WORDS
    assert judged_run(status=0, err="uvshear: error: x") is Verdict.WORDS
    assert judged_run(status=1) is Verdict.WORDS
    assert judged_run(err="RuntimeWarning: x") is Verdict.WORDS
    assert judged_run(others=(".shapes.partial",)) is Verdict.OUTPUTS
    assert judged_run(seconds=31.0) is Verdict.HANG
    failed = "uvshear: note: the noise could not be checked (ValueError: x)"
    assert judged_run(err=failed) is Verdict.TRACEBACK


def test_results_are_judged_by_what_was_told(tmp_path: Path) -> None:
    path = tmp_path / "shear.json"
    path.write_text('{"g1": 0.1, "g1_err": 0.01}')
    clean = {"shear": {"g1": 0.2, "g1_err": 0.01}}
    run, note = replace(CLEAN, result=path), "uvshear: note: 3 of 7 are wrong"
    assert judge(run, CLEAN, clean, lambda: False)[0] is Verdict.SILENT
    assert judge(run, CLEAN, clean, lambda: True)[0] is Verdict.VALID
    assert judge(replace(run, err=note), CLEAN, clean, lambda: False)[0] is Verdict.NOTED
    # A note that the clean run has, too, with other numbers, tells nothing.
    known = replace(CLEAN, err="uvshear: note: 1 of 7 are wrong")
    assert judge(replace(run, err=note), known, clean, lambda: False)[0] is Verdict.SILENT
    absent = replace(run, result=tmp_path / "gone.json")
    assert judge(absent, CLEAN, clean, lambda: False)[0] is Verdict.OUTPUTS


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, None),
        ({"e1": 0.1 + 9e-6}, None),
        ({"e1": 0.1 + 2e-5}, "e1 of a: 0.10002, not 0.1"),
        ({"e1_err": 0.0101}, "e1_err of a: 0.0101, not 0.01"),
        ({"e1": float("nan")}, "e1 of a: nan, not 0.1"),
        ({"flag": "unreliable"}, "flag of a: unreliable, not ok"),
    ],
)
def test_differences_are_measured_in_standard_errors(change: dict, words: str | None) -> None:
    assert difference_of({"a": ROW | change}, {"a": ROW}) == words


def test_a_row_that_cannot_be_ok_is_found() -> None:
    assert dishonest({"a": ROW}) is None
    assert dishonest({"a": ROW | {"e1": float("nan")}}) == "a: e1 is nan"
    assert dishonest({"a": ROW | {"e1_err": 0.0}}) == "a: e1_err is 0.0"
    assert dishonest({"a": ROW | {"flag": "unreliable"}}) == "a is unreliable and has a weight"


def test_damage_follows_from_the_seed(tmp_path: Path) -> None:
    for seed in range(30):
        files = [tmp_path / "a", tmp_path / "b"]
        words = []
        for file in files:
            file.write_bytes(bytes(range(256)) * 20)
            words.append(damage(np.random.default_rng(seed), file))
        assert words[0] == words[1]
        assert files[0].read_bytes() == files[1].read_bytes() != bytes(range(256)) * 20


def test_every_kind_is_drawn() -> None:
    assert set(SHARES) == set(KINDS)
    assert sum(SHARES.values()) == pytest.approx(1)
    assert {kind_of(seed) for seed in range(100)} == set(KINDS)


def test_the_tally_counts_by_kind() -> None:
    found = [Judged("json", 1, "", Verdict.SAME, ""), Judged("json", 2, "", Verdict.VALID, "")]
    assert tally(found) == "json: 1 same, 1 valid"
