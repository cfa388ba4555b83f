from tests.reproduce.small_targets import check_finding, finding_of


def test_every_weighting_has_its_slopes_and_its_errors():
    finding = finding_of("weighting")
    check_finding(finding, panels=1)
    values = {row.name: row.as_paper.value for row in finding.quantities}
    assert sum(name.startswith("slope") for name in values) == 8
    errors = [value for name, value in values.items() if name.startswith("median error")]
    assert len(errors) == 3
    assert all(0.9 < value < 10 for value in errors)
