import pytest

from tests.reproduce.small_targets import check_finding, run, small_target


@pytest.fixture(scope="module")
def finding():
    return run(small_target("metacal-round", galaxies=12, block=6))


def test_both_estimators_have_m_and_c(finding):
    check_finding(finding, panels=4)
    names = {row.name for row in finding.quantities}
    assert {
        f"{what} {words}, all"
        for what in ("m1", "m2", "c1", "c2")
        for words in ("of the mean", "with metacalibration")
    } <= names
    assert all(row.own.error >= 0 for row in finding.quantities)
