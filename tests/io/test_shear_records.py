"""Files of estimated shears."""

import json
from pathlib import Path

import pytest

from uvshear.errors import InputError
from uvshear.estimators.goodness import PartTest, PopulationGoodness
from uvshear.estimators.shear_estimate import ShearConditions, ShearEstimate
from uvshear.io.provenance import Provenance
from uvshear.io.shear_records import write_shear

GOODNESS = PopulationGoodness(
    100, 3, 1.1, 0.2, {"size": PartTest(0.3, {"median": 0.01, "sigma": -0.02})}
)
BIN = ShearEstimate(0.03, 0.02, 0.0, 0.02, 30, "mean")
FOUND = ShearEstimate(
    0.02,
    0.01,
    -0.01,
    0.012,
    100,
    "mean",
    bins={"10-20 uJy": BIN},
    assumed={"prior": "paper"},
    seed=3,
    conditions=ShearConditions("mean", snr_min=5.0, flux_min=17e-6),
    correction="BIAS.json",
    goodness=GOODNESS,
    remarks=("these galaxies are few",),
)


def test_a_shear_is_written_with_its_cuts_and_its_bins(tmp_path: Path) -> None:
    path = tmp_path / "shear.json"
    write_shear(path, FOUND)
    record = json.loads(path.read_text())
    assert {name: record[name] for name in FOUND.numbers()} == FOUND.numbers()
    assert record["cuts"] == {"snr_min": 5.0, "detection_min": 0.0, "flux_min_ujy": 17.0}
    assert (record["seed"], record["calibration"], record["prior"]) == (3, "BIAS.json", "paper")
    assert record["bins"] == [{"flux": "10-20 uJy", **BIN.numbers()}]
    assert record["command"] == "uvshear.estimate_shear"
    assert record["goodness"] == GOODNESS.record()
    assert record["remarks"] == ["these galaxies are few"]
    with pytest.raises(InputError, match="exists already"):
        write_shear(path, FOUND)


def test_the_provenance_of_a_command_is_kept(tmp_path: Path) -> None:
    made = Provenance("uvshear shear", ("SHAPES.fits",), {"seed": 7})
    write_shear(tmp_path / "shear.json", BIN, made)
    record = json.loads((tmp_path / "shear.json").read_text())
    assert (record["command"], record["inputs"], record["seed"]) == (
        "uvshear shear",
        ["SHAPES.fits"],
        7,
    )
    assert record["cuts"] is None
    assert record["calibration"] is None
