"""From a sky to shear with the catalogue that a source finder makes of an image: the script that the docs describe."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [pytest.mark.referee, pytest.mark.long]

SCRIPT = Path(__file__).parents[1] / "benchmarks" / "chain.py"


def test_a_finder_s_catalogue_does_nearly_as_well_as_the_true_one(tmp_path: Path) -> None:
    directory = tmp_path / "chain"
    subprocess.run(
        [sys.executable, SCRIPT, directory, "--field-arcmin", "12"], check=True, timeout=900
    )
    result = json.loads((directory / "chain.json").read_text())
    bright = result["by_flux"]["50-200 uJy"]
    assert bright["complete"] > 0.8
    assert bright["flux_over_true"] == pytest.approx(0.9, abs=0.1)
    slopes = result["slopes_where_fluxes_agree"]
    assert slopes["galaxies"] > 150
    for name in ("e1", "e2"):
        # 0.02 is what is asked for; a field of twelve arcminutes tells it to 0.01 or so
        error = slopes[f"{name}_shift_err"]
        assert error < 0.016
        assert abs(slopes[f"{name}_shift"]) < 0.02 + 2 * error
        assert slopes[f"{name}_found"] > 0.85
    truth = {"g1": 0.05, "g2": -0.03}
    shear = json.loads((directory / "shear-found.json").read_text())
    for name, true in truth.items():
        assert abs(shear[name] - true) < 4 * shear[f"{name}_err"]
        assert shear[f"{name}_err"] < 0.03
