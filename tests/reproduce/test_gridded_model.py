from tests.reproduce.small_targets import check_finding, finding_of


def test_every_model_has_its_slopes_and_its_time():
    finding = finding_of("gridded-model")
    check_finding(finding, panels=1)
    rows = {row.name: row for row in finding.quantities}
    assert rows["slope of e1, model averaged as the data"].as_paper.error > 0
    assert rows["slope of e1, exact facets"].own.error > 0
    times = [
        (row.as_paper or row.own).value
        for name, row in rows.items()
        if name.startswith("processor time")
    ]
    assert times[2] > 3 * times[0]
