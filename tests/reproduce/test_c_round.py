from tests.reproduce.small_targets import check_finding, finding_of


def test_every_case_has_its_additive_bias():
    finding = finding_of("c-round")
    check_finding(finding, panels=2)
    biases = [row for row in finding.quantities if row.name.startswith("c")]
    assert biases
    assert not any((row.own or row.as_paper).error < 0 for row in biases)


def test_the_cost_of_round_weights_is_stated():
    kept = [row for row in finding_of("c-round").quantities if row.name.startswith("information")]
    assert len(kept) == 6
    assert all(0.5 < row.own.value < 1 for row in kept)
