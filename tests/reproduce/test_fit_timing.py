from tests.reproduce.small_targets import check_finding, run, small_target
from uvshear.reproduce import fit_timing


def test_times_and_speeds_are_told(monkeypatch):
    monkeypatch.setattr(fit_timing, "available_cores", lambda: 1)
    finding = run(small_target("timing"))
    check_finding(finding, panels=1)
    first = finding.quantities[0]
    assert first.paper.value == 10
    assert 0 < first.own.value < 10
    assert 0 < first.as_paper.value < 10


def test_workers_are_doubled_up_to_the_number_of_cores(monkeypatch):
    monkeypatch.setattr(fit_timing, "available_cores", lambda: 6)
    assert list(small_target("timing").tasks()) == [
        *("cells-1", "cells-2", "cells-4"),
        *("exact-1", "exact-2", "exact-4"),
    ]
    assert small_target("timing").is_alone
