"""Files of simulated biases."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.bias import Bias, BiasSimulation
from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.shear_estimate import ShearConditions
from uvshear.galaxy import SizeFluxRelation
from uvshear.io.bias_records import read_bias, write_bias
from uvshear.io.provenance import Provenance

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
    "bins": [{"flux": "10-20 uJy", **NUMBERS, "m1": -0.2}],
}


def _written(tmp_path: Path, **changes: object) -> Path:
    record = {**RECORD, **changes}
    path = tmp_path / "bias.json"
    path.write_text(json.dumps({name: v for name, v in record.items() if v != "left out"}))
    return path


def test_numbers_and_conditions_are_read(tmp_path: Path) -> None:
    found = read_bias(_written(tmp_path))
    assert [*found.m, *found.m_err] == [-0.1, 0.05, 0.01, 0.02]
    assert [*found.c, *found.c_err] == [1e-3, 2e-3, 1e-4, 2e-4]
    assert [part.name for part in found.bins] == ["10-20 uJy"]
    assert found.bins[0].m[0] == -0.2
    assert found.simulation is not None
    conditions = found.simulation.conditions
    assert (conditions.estimator, conditions.snr_min, conditions.prior) == (
        "moments",
        10.0,
        "paper",
    )
    assert conditions.flux_min == pytest.approx(15e-6)
    assert not conditions.averages_cells
    assert found.simulation.cuts_on_measured


def test_a_path_may_be_text(tmp_path: Path) -> None:
    assert read_bias(str(_written(tmp_path))).simulation is not None


def test_files_of_the_first_release_are_in_the_frame_of_l_and_m(tmp_path: Path) -> None:
    """m of both components stays, and so does c1; c2 changes its sign."""
    found = read_bias(_written(tmp_path, frame="left out"))
    assert found.c.tolist() == [1e-3, -2e-3]
    assert found.m.tolist() == [-0.1, 0.05]
    assert found.bins[0].c[1] == -2e-3
    assert found.frame == "sky"


def test_the_facets_and_the_cut_are_read(tmp_path: Path) -> None:
    found = read_bias(_written(tmp_path, facet="cell-average", selection="catalogue")).simulation
    assert found is not None
    assert found.conditions.averages_cells
    assert not found.cuts_on_measured


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"c1": "left out"}, "has no number 'c1'; `uvshear bias` writes one"),
        ({"c2_err": None}, "has no number 'c2_err'"),
        ({"snr_min": "ten"}, "'snr_min' is \"ten\"; a number is needed"),
        ({"snr_min": -1}, "'snr_min' is -1; a number of 0 or more is needed"),
        ({"m1_err": 1e300}, "'m1_err' is 1e+300; a number between 0 and 1000 is needed"),
        ({"m1_err": -0.1}, "'m1_err' is -0.1; a number between 0 and 1000 is needed"),
        ({"m2": 1e10}, "'m2' is 1e+10; a number between -1000 and 1000 is needed"),
        ({"c1": 10**400}, "'c1' is 1000"),
        ({"c2": [0.1]}, "'c2' is [0.1]; a number is needed"),
        ({"n": 2.5}, "'n' is 2.5; a whole number is needed"),
        ({"seed": -1}, "'seed' is -1; a whole number is needed"),
        ({"flux_max_ujy": "none"}, "'flux_max_ujy' is \"none\"; a number is needed"),
        ({"facet": "round"}, "'facet' is \"round\"; exact or cell-average is needed"),
        ({"selection": 3}, "'selection' is 3; measured or catalogue is needed"),
        ({"legacy_shear": "no"}, "'legacy_shear' is \"no\"; true or false is needed"),
        ({"estimator": ["moments"]}, "'estimator' is [\"moments\"]; a word is needed"),
        ({"frame": None}, "'frame' is null; a word is needed"),
        ({"frame": "left out", "version": "0.2.0"}, "has no word 'frame'"),
        ({"shears": [0.02]}, "an entry of 'shears' is no pair of numbers"),
        ({"shears": [[1, 1]]}, "an entry of 'shears' is no pair of numbers"),
        ({"bins": {"flux": "10-20 uJy"}}, "a list is needed"),
        ({"bins": [{"n": 3}]}, "an entry of 'bins' has no word 'flux'"),
        ({"bins": [{"flux": "a", **NUMBERS, "c1": "x"}]}, "bin a: 'c1' is \"x\"; a number"),
        ({"bins": 2 * [{"flux": "a", **NUMBERS}]}, "two bins of the same flux"),
        ({"cuts": {"snr_min": 5.0}}, "'snr_min' is 10.0, but 5.0 in 'cuts'"),
        ({"cuts": 3}, "'cuts' is no object"),
        ({"population": {"flux": {"minimum_ujy": 1e-300}}}, "must lie between 1e-06 and 1e+12"),
        (
            {"population": {"colour": {}}},
            "unknown entry 'colour'; a population has the entries flux, size, ellipticity",
        ),
    ],
)
def test_a_damaged_file_is_refused(
    tmp_path: Path, changes: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError) as error:
        read_bias(_written(tmp_path, **changes))
    assert "bias.json: " in str(error.value)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_another_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "list.json").write_text("[]")
    with pytest.raises(InputError, match="is not a file written by `uvshear bias`"):
        read_bias(tmp_path / "list.json")
    with pytest.raises(InputError, match="no such file"):
        read_bias(tmp_path / "nothing.json")


def _assert_same(got: Bias, expected: Bias) -> None:
    for name in ("m", "m_err", "c", "c_err", "response"):
        np.testing.assert_array_equal(getattr(got, name), getattr(expected, name))
    for name in ("name", "n", "failed", "frame"):
        assert getattr(got, name) == getattr(expected, name)
    assert len(got.bins) == len(expected.bins)
    for part, other in zip(got.bins, expected.bins, strict=True):
        _assert_same(part, other)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    inside = Bias("20-50 uJy", *rng.uniform(size=(5, 2)), 30, failed=1)
    population = UnlensedPopulation(size=SizeFluxRelation(sigma=0.4))
    simulation = BiasSimulation(
        ShearConditions(
            "bayesian", Bayesian(population).record(), 12.0, flux_min=17e-6, averages_cells=True
        ),
        cuts_on_measured=True,
        flux_max=70e-6,
        keeps_scale_lengths=True,
        position_sigma=1e-6,
        shears=(0.02 + 0.01j, -0.02 - 0.01j),
        density=2.8,
        seed=5,
    )
    bias = Bias("all", *rng.uniform(size=(5, 2)), 90, 2, (inside,), simulation=simulation)
    path = tmp_path / "bias.json"
    write_bias(path, bias)
    got = read_bias(path)
    _assert_same(got, bias)
    assert got.simulation is not None
    assert got.simulation.flux_max == pytest.approx(70e-6)
    assert got.simulation.position_sigma == pytest.approx(1e-6)
    assert got.simulation.conditions.flux_min == pytest.approx(17e-6)
    for name in ("cuts_on_measured", "keeps_scale_lengths", "shears", "density", "seed"):
        assert getattr(got.simulation, name) == getattr(simulation, name)
    assert got.simulation.conditions.assumed == simulation.conditions.assumed
    record = json.loads(path.read_text())
    assert record["cuts"] == {
        "snr_min": 12.0,
        "selection": "measured",
        "flux_min_ujy": 17.0,
        "flux_max_ujy": 70.0,
    }
    assert {"version", "command", "inputs", "seed", "frame", "date"} <= set(record)
    with pytest.raises(InputError, match="exists already"):
        write_bias(path, bias)


def test_m_that_was_not_simulated_is_not_read(tmp_path: Path) -> None:
    nothing, some = np.full(2, math.nan), np.array([1e-3, 2e-3])
    bias = Bias("all", nothing, nothing, some, some, nothing, 5)
    write_bias(
        tmp_path / "bias.json",
        bias,
        Provenance("uvshear bias", options={"snr_min": 5.0, "prior": "population.json"}),
    )
    got = read_bias(tmp_path / "bias.json")
    assert np.isnan(got.m).all()
    assert got.simulation is not None
    assert got.simulation.conditions.snr_min == 5.0
