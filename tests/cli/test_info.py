"""``uvshear info`` on a simulated set."""

from collections.abc import Callable
from pathlib import Path

from tests.io.measurement_sets import change, written


def test_a_set_is_described(uvshear: Callable, tmp_path: Path) -> None:
    outcome = uvshear("info", written(tmp_path))
    assert outcome.status == 0, outcome.err
    for fact in (
        "ska-mid-aa1",
        "950 - 1190 MHz, 4 channels of 60000 kHz; XX YY",
        "field 0 simulated",
        "1680 and 0 autocorrelations",
        "averaged over",
        "UVW is X(ANTENNA1) - X(ANTENNA2)",
    ):
        assert fact in outcome.out
    assert not outcome.err


def test_wrong_weights_are_remarked_on(uvshear: Callable, tmp_path: Path) -> None:
    path = written(tmp_path)
    change(path, "WEIGHT_SPECTRUM", 1e-3)
    outcome = uvshear("info", path)
    assert outcome.status == 0
    assert "times what the weights say" in outcome.err


def test_what_is_no_set_ends_with_one_line(uvshear: Callable, tmp_path: Path) -> None:
    outcome = uvshear("info", tmp_path)
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1
    assert "not a Measurement Set" in outcome.err
