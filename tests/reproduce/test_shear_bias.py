import numpy as np
import pytest

from tests.reproduce.small_targets import check_finding, finding_of, small_target
from uvshear.reproduce.paper_pointing import ABOUT_TRANSIT, FROM_TRANSIT, UNTIL_TRANSIT
from uvshear.reproduce.shear_bias import SHEAR, SHEARS


def test_eight_shears_of_one_modulus_add_up_to_zero():
    assert len(SHEARS) == 8
    assert np.abs(SHEARS) == pytest.approx(np.full(8, SHEAR))
    assert abs(sum(SHEARS)) < 1e-12


def test_all_rows_of_single_sources_of_table_2_are_there():
    finding = finding_of("shear-bias")
    check_finding(finding, panels=2)
    rows = {row.name: row for row in finding.quantities}
    row = rows["m1, SNR ≥ 10, single source"]
    assert (row.paper.value, row.paper.error) == (-0.0904, 0.0186)
    assert row.as_paper.error > 0
    assert row.own.error > 0
    assert rows["c2, SNR ≥ 25, single source"].paper.value == -0.0007
    assert sum("rings of ten" in name for name in rows) == 2


@pytest.mark.parametrize("track", ["track about transit", "track that begins at transit"])
def test_c_of_both_tracks_is_compared_by_its_modulus(track):
    rows = {row.name: row for row in finding_of("shear-bias").quantities}
    c1, c2, modulus = (rows[f"{what}, SNR ≥ 10, {track}"] for what in ("c1", "c2", "modulus of c"))
    assert modulus.paper.value == pytest.approx(np.hypot(0.00655, 0.00632))
    assert modulus.paper.error == pytest.approx(0.00048, abs=1e-5)
    for column in ("as_paper", "own"):
        values = [getattr(row, column).value for row in (c1, c2, modulus)]
        assert values[2] == pytest.approx(np.hypot(*values[:2]))
    cases = {task.survey.pointing.times for task in small_target("shear-bias").tasks().values()}
    assert cases == {ABOUT_TRANSIT, FROM_TRANSIT, UNTIL_TRANSIT}


def test_the_distribution_of_fluxes_gives_the_paper_s_number_of_bright_sources():
    (row,) = (row for row in finding_of("shear-bias").quantities if "25 µJy" in row.name)
    assert row.paper.value == 5810
    assert row.as_paper.value == pytest.approx(5810, abs=10)
