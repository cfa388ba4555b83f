"""``uvshear info`` on a simulated set."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.io.measurement_sets import change, written
from uvshear.cli.reading import scans_of
from uvshear.errors import InputError


def test_a_set_is_described(uvshear: Callable, tmp_path: Path) -> None:
    outcome = uvshear("info", written(tmp_path))
    assert outcome.status == 0, outcome.err
    for fact in (
        "ska-mid-aa1",
        "950 - 1190 MHz, 4 channels of 60000 kHz; XX YY",
        "field 0 simulated",
        "1680 cross-correlations, 0 autocorrelations",
        "none in time, none in frequency",
        "UVW is X(ANTENNA1) - X(ANTENNA2)",
    ):
        assert fact in outcome.out
    assert not outcome.err


def test_wrong_weights_are_remarked_on(uvshear: Callable, tmp_path: Path) -> None:
    path = written(tmp_path)
    change(path, "WEIGHT_SPECTRUM", 1e-3)
    outcome = uvshear("info", path)
    assert outcome.status == 0
    assert "times what the weights claim" in outcome.err


def test_what_is_no_set_ends_with_one_line(uvshear: Callable, tmp_path: Path) -> None:
    outcome = uvshear("info", tmp_path)
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1
    assert "not in a known format of visibilities" in outcome.err


def test_scans_are_numbers_and_ranges() -> None:
    assert scans_of("3,5-7, 3") == (3, 5, 6, 7)
    for wrong in ("8-5", "3-", "-3", "three", ""):
        with pytest.raises(InputError, match="numbers and ranges"):
            scans_of(wrong)


def test_times_that_no_calendar_has_are_shown_as_they_are(
    uvshear: Callable, tmp_path: Path
) -> None:
    path = written(tmp_path)
    assert "2000-01-01T" in uvshear("info", path).out
    for value, words in ((1e30, "MJD 1.15741e+25 to MJD 1.15741e+25"), (-1e9, "MJD -11574")):
        for column in ("TIME", "TIME_CENTROID"):
            change(path, column, value)
        outcome = uvshear("info", path)
        assert outcome.status == 0
        assert words in outcome.out
    for column in ("TIME", "TIME_CENTROID"):
        change(path, column, np.nan)
    outcome = uvshear("info", path)
    assert outcome.status == 0
    assert "have a time or integration time that is negative, NaN, infinite" in outcome.err
