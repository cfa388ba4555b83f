from tests.reproduce.small_targets import check_finding, finding_of, small_target


def test_every_case_has_its_additive_bias():
    finding = finding_of("c-round")
    check_finding(finding, panels=2)
    biases = [row for row in finding.quantities if row.name.startswith("c")]
    assert biases
    assert not any((row.own or row.as_paper).error < 0 for row in biases)


def test_the_cost_of_round_weights_is_stated():
    rows = [row for row in finding_of("c-round").quantities if "of the information" in row.name]
    whole, half = (
        [row.own.value for row in rows if row.name.endswith(words)]
        for words in (", weights for a round PSF", ", half of the weighting for a round PSF")
    )
    assert len(whole) == len(half) == 6
    assert all(0.5 < a < b < 1 for a, b in zip(whole, half, strict=True))


def test_more_galaxies_are_measured_where_c_varies_more():
    target = small_target("c-round", galaxies=10, grown=(1.0, 2.0, 3.0), fewer=2)
    numbers = {case: target.galaxies_of(case) for case in target.cases()}
    assert [numbers[f"round-{distance}"] for distance in (0, 40, 60)] == [10, 20, 30]
    assert numbers["half-0"] == numbers["roundcells-60"] == numbers["roundnoise-60"] == 2
    assert "roundnoise-0" not in numbers


def test_the_experiment_and_its_remark_are_there():
    finding = finding_of("c-round")
    names = [row.name for row in finding.quantities]
    assert any(name.endswith("experiment: noise as round as the PSF") for name in names)
    assert "c2 at 0 deg, SNR ≥ 10, half of the weighting for a round PSF" in names
    assert "make the PSF round change c1 at 60 deg" in finding.remarks[-1]
