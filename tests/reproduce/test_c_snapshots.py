import pytest

from tests.reproduce.small_targets import check_finding, finding_of
from uvshear.reproduce.c_snapshots import TRACKS, WORDS, _leakage
from uvshear.reproduce.finding import Estimate


def test_every_case_has_its_additive_bias():
    finding = finding_of("c-snapshots")
    check_finding(finding, panels=2)
    biases = [row for row in finding.quantities if row.name.startswith("c")]
    assert biases
    assert not any((row.own or row.as_paper).error < 0 for row in biases)


def test_snapshots_add_up_to_eight_hours():
    for ranges in TRACKS.values():
        assert sum(stop - start for start, stop in ranges) == 8 * 3600
    assert set(WORDS) == set(TRACKS)


def test_the_leakage_is_the_slope_of_both_components():
    points = [
        (0.1 - 0.2j, (Estimate(0.003, 0.001), Estimate(-0.006, 0.001))),
        (-0.1 + 0j, (Estimate(-0.003, 0.001), Estimate(0.0, 0.001))),
    ]
    assert _leakage(points).value == pytest.approx(0.03)
    assert _leakage(points).error == pytest.approx(0.001 / 0.06**0.5)
