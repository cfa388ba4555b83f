from tests.reproduce.small_targets import check_finding, finding_of
from uvshear.reproduce.c_facets import FacetBias


def test_every_case_has_its_additive_bias():
    finding = finding_of("c-facets")
    check_finding(finding, panels=2)
    biases = [row for row in finding.quantities if row.name.startswith("c")]
    assert biases
    assert not any((row.own or row.as_paper).error < 0 for row in biases)


def test_growing_facets_have_fifty_more_cells_each_ten_degrees():
    cases = FacetBias().cases()
    assert cases["growing-40"].facets.rule.more == 200
    assert cases["fixed-40"].facets.rule.more == 0
    assert cases["growing-0"].facets == cases["fixed-0"].facets
