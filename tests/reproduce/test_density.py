from tests.reproduce.small_targets import check_finding, run, small_target


def test_slopes_at_the_density_of_the_paper_are_beside_its_own():
    target = small_target("density", galaxies=12, densities=(2.8,), fields=1)
    finding = run(target)
    check_finding(finding, panels=2)
    row = finding.quantities[0]
    assert row.paper.value == 0.9365
    assert row.as_paper.error > 0
    assert row.own.error > 0
