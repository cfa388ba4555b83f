"""``uvshear average`` on small sets."""

from collections.abc import Callable
from pathlib import Path

import pytest


def test_a_set_is_averaged_described_and_measured(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    compact, shapes = tmp_path / "compact.ms", tmp_path / "shapes.fits"
    outcome = uvshear("average", field, "--field-arcmin", "4", "-o", compact)
    assert outcome.status == 0, outcome.err
    assert "rows from 168 visibilities" in outcome.out
    described = uvshear("info", compact)
    assert "over cells of (u, v, w)" in described.out
    assert "ANTENNA1" not in described.out
    assert not described.err
    measured = uvshear("measure", compact, "--catalogue", catalogue, "-o", shapes)
    assert measured.status == 0, measured.err
    assert shapes.exists()


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--field-arcmin", "700"), "at most 600 arcmin"),
        (("--field-arcmin", "0"), "a number above 0"),
        (("--field-arcmin", "4", "--accuracy", "0.6"), "up to 0.5"),
        (("--field-arcmin", "4", "--scans", "9"), "no rows of scan 9"),
        ((), "--field-arcmin"),
    ],
)
def test_what_cannot_be_averaged_ends_with_one_line(
    uvshear: Callable, tmp_path: Path, field: Path, words: tuple[str, ...], reason: str
) -> None:
    outcome = uvshear("average", field, *words, "-o", tmp_path / "compact.ms")
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1
    assert reason in outcome.err
    assert not (tmp_path / "compact.ms").exists()


def test_averages_are_not_averaged_and_have_no_scans(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    compact = tmp_path / "compact.ms"
    assert uvshear("average", field, "--field-arcmin", "4", "-o", compact).status == 0
    for words in (
        ("average", compact, "--field-arcmin", "4", "-o", tmp_path / "again.ms"),
        ("measure", compact, "--catalogue", catalogue, "--scans", "1", "-o", tmp_path / "s.fits"),
        ("average", compact, "--field-arcmin", "4", "-o", compact, "--overwrite"),
    ):
        outcome = uvshear(*words)
        assert outcome.status == 2
        assert outcome.err.count("\n") == 1
    assert not (tmp_path / "again.ms").exists()
