import pytest

from tests.reproduce.small_targets import check_finding, finding_of
from uvshear.reproduce.c_size import SizeBias


def test_every_case_has_its_additive_bias():
    finding = finding_of("c-size")
    check_finding(finding, panels=1)
    biases = [row for row in finding.quantities if row.name.startswith("c")]
    assert biases
    assert not any((row.own or row.as_paper).error < 0 for row in biases)


def test_both_ways_to_a_signal_to_noise_ratio_of_25():
    cases = SizeBias().cases()
    assert cases["flux"].population.flux.minimum == pytest.approx(25e-6)
    assert cases["flux"].snr == 10
    assert cases["noise"].snr == 25
