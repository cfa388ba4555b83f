from tests.reproduce.small_targets import check_finding, run, small_target


def test_the_shear_of_a_field_without_one_is_told():
    target = small_target("shear-density", galaxies=20, densities=(1.0,), fields=1)
    assert {task.ring for task in target.tasks().values()} == {10}
    finding = run(target)
    check_finding(finding, panels=2)
    for row in finding.quantities:
        assert abs(row.own.value) < 6 * row.own.error + 0.1
