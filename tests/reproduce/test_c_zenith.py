from tests.reproduce.small_targets import check_finding, finding_of


def test_every_case_has_its_additive_bias():
    finding = finding_of("c-zenith")
    check_finding(finding, panels=4)
    biases = [row for row in finding.quantities if row.name.startswith("c")]
    assert biases
    assert not any((row.own or row.as_paper).error < 0 for row in biases)


def test_the_numbers_of_table_2_are_beside_those_at_the_zenith():
    rows = {row.name: row for row in finding_of("c-zenith").quantities}
    assert rows["c1 at 0 deg, SNR ≥ 10"].paper.value == 0.00655
    assert rows["c1 at 40 deg, SNR ≥ 10"].paper is None
