"""Files of `uvshear bias`, read to correct a shear."""

import json
from pathlib import Path

import pytest

from uvshear.errors import InputError
from uvshear.io.bias_records import read_correction

NUMBERS = {
    "m1": -0.1,
    "m1_err": 0.01,
    "m2": 0.05,
    "m2_err": 0.02,
    "c1": 1e-3,
    "c1_err": 1e-4,
    "c2": 2e-3,
    "c2_err": 2e-4,
}
RECORD = {
    **NUMBERS,
    "estimator": "moments",
    "frame": "sky",
    "snr_min": 10.0,
    "flux_min_ujy": 15.0,
    "prior": "paper",
    "bins": [{"flux": "10-20 uJy", **NUMBERS, "m1": -0.2}, {"n": 3}],
}


def _written(tmp_path: Path, **changes: object) -> Path:
    record = {**RECORD, **changes}
    path = tmp_path / "bias.json"
    path.write_text(json.dumps({name: v for name, v in record.items() if v != "left out"}))
    return path


def test_numbers_and_options_are_read(tmp_path: Path) -> None:
    found = read_correction(_written(tmp_path))
    first, second = found.total
    assert (first.m, first.m_err, first.c, first.c_err) == (-0.1, 0.01, 1e-3, 1e-4)
    assert (second.m, second.m_err, second.c, second.c_err) == (0.05, 0.02, 2e-3, 2e-4)
    assert list(found.bins) == ["10-20 uJy"]
    assert found.bins["10-20 uJy"][0].m == -0.2
    assert (found.estimator, found.snr_min, found.prior) == ("moments", 10.0, "paper")
    assert found.flux_min == pytest.approx(15e-6)
    assert not found.averages_cells
    assert found.cuts_on_measured


def test_a_path_may_be_text(tmp_path: Path) -> None:
    assert read_correction(str(_written(tmp_path))).estimator == "moments"


def test_files_of_the_first_release_are_in_the_frame_of_l_and_m(tmp_path: Path) -> None:
    """m of both components stays, and so does c1; c2 changes its sign."""
    found = read_correction(_written(tmp_path, frame="left out"))
    assert [part.c for part in found.total] == [1e-3, -2e-3]
    assert [part.m for part in found.total] == [-0.1, 0.05]
    assert found.bins["10-20 uJy"][1].c == -2e-3


def test_the_facets_and_the_cut_are_told(tmp_path: Path) -> None:
    found = read_correction(_written(tmp_path, facet="cell-average", selection="catalogue"))
    assert found.averages_cells
    assert not found.cuts_on_measured


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"frame": "galactic"}, "is in the frame 'galactic'; the frame 'sky' is needed"),
        ({"flux_max_ujy": 50.0}, "is the bias of galaxies below 50.0 uJy"),
        ({"wraps": "moments"}, "was simulated with wraps = moments"),
        ({"legacy_shear": True}, "was simulated with legacy_shear = True"),
        ({"position_error_arcsec": 0.3}, "was simulated with position_error_arcsec = 0.3"),
        ({"m1": "left out"}, "has no number 'm1'; `uvshear bias` with a shear writes one"),
        ({"c2_err": None}, "has no number 'c2_err'"),
        ({"snr_min": "ten"}, "has no number 'snr_min'"),
        ({"m2": -1.5}, "m is -1 or less"),
    ],
)
def test_a_bias_that_is_not_of_measured_shapes_is_refused(
    tmp_path: Path, changes: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError) as error:
        read_correction(_written(tmp_path, **changes))
    assert "bias.json: " in str(error.value)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_another_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "list.json").write_text("[]")
    with pytest.raises(InputError, match="is not a file written by `uvshear bias`"):
        read_correction(tmp_path / "list.json")
    with pytest.raises(InputError, match="no such file"):
        read_correction(tmp_path / "nothing.json")
