from tests.reproduce.small_targets import check_finding, run, small_target
from uvshear.reproduce.paper_pointing import UNTIL_TRANSIT
from uvshear.reproduce.shear_bias import SHEARS


def test_all_rows_of_multiple_sources_of_table_2_are_there():
    target = small_target("shear-bias-crowded", galaxies=20)
    tasks = target.tasks()
    assert {task.shears[task.shear] for task in tasks.values()} == {*SHEARS, 0j}
    ends = {task.pointing.times for task in tasks.values() if not any(task.shears)}
    assert ends == {UNTIL_TRANSIT}
    finding = run(target)
    check_finding(finding, panels=2)
    rows = {row.name: row for row in finding.quantities}
    assert rows["m2, SNR ≥ 10, multiple sources"].paper.value == -0.1864
    assert rows["c1, SNR ≥ 25, multiple sources"].paper.value == 0.00089
    assert rows["m1, SNR ≥ 10, multiple sources"].own is not None
    other = rows["c2, SNR ≥ 10, multiple sources, track that ends at transit"]
    assert other.paper.value == 0.00578
    assert other.as_paper.error > 0
