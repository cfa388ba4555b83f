import numpy as np

from tests.reproduce.small_targets import check_finding, run, small_target
from uvshear.reproduce.facet_size import FacetSize, table_rows
from uvshear.reproduce.published_figures import PublishedFigures


def test_the_rows_are_those_of_table_1():
    rows = table_rows()
    assert [str(row) for row in rows][:2] == ["150-200", "100-150"]
    assert str(rows[-1]) == "10-20"
    assert [row.cells for row in rows] == PublishedFigures.read("facet-size").values["cells"]


def test_every_row_of_the_table_has_our_slopes_beside_it():
    target = small_target("facet-size", searched=2)
    finding = run(target)
    check_finding(finding, panels=3)
    slopes = [row for row in finding.quantities if row.name.startswith("slope")]
    assert len(slopes) == 14
    assert all(row.paper and row.as_paper and row.own for row in slopes)
    assert all(0.5 < row.as_paper.value < 1.5 for row in slopes)


def test_the_cells_of_the_table_are_among_those_of_the_search():
    target = FacetSize()
    for row in table_rows():
        tried = target._tried(row)
        assert row.cells in tried
        assert all(np.array(tried) % 2 == 0)
