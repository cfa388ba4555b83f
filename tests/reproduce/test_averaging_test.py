from tests.reproduce.small_targets import check_finding, finding_of


def test_fine_samples_give_the_shapes_of_the_paper_s_samples():
    finding = finding_of("averaging")
    check_finding(finding, panels=1)
    changes = {
        row.name.rpartition(", ")[2]: row.as_paper.value
        for row in finding.quantities
        if row.name.startswith("rms change")
    }
    assert changes["30 kHz and 0.5 s"] < changes["1 MHz and 8 s"]
