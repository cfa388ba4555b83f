from tests.reproduce.small_targets import check_finding, run, small_target


def test_slopes_at_the_density_of_the_paper_are_beside_its_own():
    target = small_target("density", galaxies=12, densities=(2.8,), fields=1, whole=10)
    finding = run(target)
    check_finding(finding, panels=2)
    row = finding.quantities[0]
    assert row.paper.value == 0.9365
    assert row.as_paper.error > 0
    assert row.own.error > 0
    whole = [row for row in finding.quantities if "10 galaxies in one field" in row.name]
    assert [row.paper.value for row in whole] == [0.9365, 0.9262, 1.0]
    assert all(row.as_paper.value > 0 for row in whole[:2])
    assert all(row.own is None for row in whole)
