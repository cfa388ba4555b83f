import json
import re
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import pytest

from uvshear import __version__

QUICK = ["--galaxies", "100", "--integration-s", "3600", "--seed", "2", "--threads", "1"]
FIELDS = ("m1", "m1_err", "m2", "m2_err", "c1", "c1_err", "c2", "c2_err", "n")


def test_the_bias_of_moments_is_told_and_written(uvshear: Callable, tmp_path: Path) -> None:
    output = tmp_path / "bias.json"
    words = ("--shear", "0.03", "--snr-min", "15")
    outcome = uvshear("bias", "--estimator", "moments", *QUICK, *words, "-o", output)
    assert outcome.status == 0, outcome.err
    record = json.loads(output.read_text())
    assert set(FIELDS) | {"snr_min", "seed", "version"} <= set(record)
    assert record["frame"] == "sky"
    assert record["command"] == "uvshear bias"
    assert record["inputs"] == []
    assert record["options"]["estimator"] == "moments"
    assert record["cuts"] == {
        "snr_min": 15.0,
        "selection": "catalogue",
        "flux_min_ujy": 0.0,
        "flux_max_ujy": None,
    }
    assert datetime.fromisoformat(record["date"]).utcoffset() is not None
    assert (record["snr_min"], record["seed"], record["version"]) == (15.0, 2, __version__)
    assert abs(record["m1"]) < 0.005
    assert record["m1_err"] < 0.003
    assert abs(record["c1"]) < 5e-4
    assert sum(part["n"] for part in record["bins"]) == record["n"] < 100
    assert [part["flux"] for part in record["bins"]] == [
        "10-20 uJy",
        "20-50 uJy",
        "50-200 uJy",
    ]
    assert f"m1 = {record['m1']:+.5f}" in outcome.out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--shear", "1.5"], "--shear 1.5: |g| below 1 is needed"),
        (["--layout", "no-such-array"], "no-such-array"),
        (["--position-error-arcsec", "3"], "allow for errors of at most"),
        (
            ["--facet", "cell-average"],
            "--estimator moments: facets of cell averages work only with",
        ),
        (
            ["--prior", "fitted"],
            "--prior fitted: --estimator moments has no prior; only bayesian has",
        ),
        (["--prior", "population.json"], "--estimator moments has no prior; only bayesian has one"),
        (
            ["--wraps", "bayesian", "--prior", "fitted"],
            "--wraps bayesian: --estimator moments does not wrap another estimator; only metacal does",
        ),
        (["--profile", "square"], "--profile square: 'square' is not a known profile"),
    ],
)
def test_a_wrong_call_is_one_line(
    uvshear: Callable, tmp_path: Path, words: list[str], message: str
) -> None:
    output = tmp_path / "bias.json"
    outcome = uvshear("bias", "--estimator", "moments", *QUICK, *words, "-o", output)
    assert outcome.status == 2
    assert message in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert not output.exists()


@pytest.mark.parametrize(
    ("estimator", "words", "message"),
    [
        ("metacal", "--selection measured", "is not the one in a table of shapes"),
        ("metacal", "--density 3 --wraps moments", "--wraps: applies only to isolated galaxies"),
        ("metacal", "--prior fitted", "--estimator metacal has no prior"),
        ("metacal", "--wraps moments --prior fitted", "--wraps moments has no prior"),
        ("metacal", "--wraps spin", "--wraps spin: 'spin' is not a known estimator"),
        (
            "spin",
            "",
            "--estimator spin: 'spin' is not a known estimator; the known names are mean, moments, bayesian,",
        ),
    ],
)
def test_what_would_not_be_heeded_is_refused(
    uvshear: Callable, tmp_path: Path, estimator: str, words: str, message: str
) -> None:
    output = tmp_path / "bias.json"
    outcome = uvshear("bias", "--estimator", estimator, *QUICK, *words.split(), "-o", output)
    assert outcome.status == 2
    assert message in outcome.err
    assert len(outcome.err.splitlines()) == 1


@pytest.mark.parametrize(
    "words", ["--selection measured", "--no-rings", "--position-error-arcsec 1"]
)
def test_what_a_crowd_does_not_know_is_refused(
    uvshear: Callable, tmp_path: Path, words: str
) -> None:
    output = tmp_path / "bias.json"
    outcome = uvshear(
        "bias", "--estimator", "moments", "--galaxies", "100", "--density", "3",
        *words.split(), "-o", output,
    )  # fmt: skip
    assert outcome.status == 2
    assert words.split(maxsplit=1)[0] in outcome.err
    assert not output.exists()


@pytest.mark.parametrize("estimator", ["mean", "moments"])
@pytest.mark.parametrize("words", ["--flux-min-ujy 300", "--selection measured --snr-min 1e6"])
def test_cuts_that_leave_nothing_are_told(
    uvshear: Callable, tmp_path: Path, estimator: str, words: str
) -> None:
    output = tmp_path / "bias.json"
    outcome = uvshear("bias", "--estimator", estimator, *QUICK, *words.split(), "-o", output)
    assert outcome.status == 2
    assert re.search("0 galaxies|no galaxy contributes to the shear", outcome.err)
    assert not output.exists()


def test_a_population_is_not_overwritten(uvshear: Callable, tmp_path: Path) -> None:
    path = tmp_path / "population.json"
    path.write_text("{}")
    words = ("--prior", path, "-o", path, "--overwrite")
    outcome = uvshear("bias", "--estimator", "bayesian", *QUICK, *words)
    assert outcome.status == 2
    assert "is an input too" in outcome.err
    assert path.read_text() == "{}"


def test_nothing_to_learn_a_population_from_is_told(uvshear: Callable, tmp_path: Path) -> None:
    words = ("--prior", "fitted", "--flux-min-ujy", "300", "-o", tmp_path / "bias.json")
    outcome = uvshear("bias", "--estimator", "bayesian", *QUICK, *words)
    assert outcome.status == 2
    assert "no galaxy passes the cuts, so that no population can be fitted" in outcome.err


def test_the_papers_facets_round_galaxies(uvshear: Callable, tmp_path: Path) -> None:
    """Bright ones, which noise does not bias: what is lost is lost by averaging in cells."""
    words = ("--flux-min-ujy", "100", "--snr-at", "10", "100", "--no-rings", "--legacy-shear")
    found = {}
    for facet in ("exact", "cell-average"):
        output = tmp_path / f"{facet}.json"
        outcome = uvshear(
            *("bias", "--estimator", "mean", *QUICK, *words, "--facet", facet, "-o", output)
        )
        assert outcome.status == 0, outcome.err
        found[facet] = json.loads(output.read_text())
    assert found["cell-average"]["facet"] == "cell-average"
    lost = found["exact"]["m1"] - found["cell-average"]["m1"]
    assert 0.01 < lost < 0.1


@pytest.mark.long
def test_a_population_of_ones_own_is_what_galaxies_are_taken_for(
    uvshear: Callable, tmp_path: Path
) -> None:
    population = tmp_path / "population.json"
    population.write_text('{"size": {"intercept": -0.73}}')
    words = ("--no-rings", "--shear", "0.05", "--flux-min-ujy", "50", "--flux-max-ujy", "75")
    m1 = {}
    for prior in ("paper", population):
        output = tmp_path / "bias.json"
        outcome = uvshear(
            *("bias", "--estimator", "bayesian", *QUICK, *words, "--prior", prior),
            *("-o", output, "--overwrite"),
        )
        assert outcome.status == 0, outcome.err
        record = json.loads(output.read_text())
        m1[record["prior"]] = record["m1"]
    assert record["population"]["size"]["intercept"] == -0.73
    assert record["galaxies"] == 100 > record["n"]
    # Taken for larger than they are, they seem less elliptical in truth, and to answer more to a shear.
    assert 0.001 < m1["paper"] - m1["file"] < 0.1


def test_metacal_wraps_another_estimator(uvshear: Callable, tmp_path: Path) -> None:
    output = tmp_path / "bias.json"
    words = ("--wraps", "moments", "--flux-min-ujy", "50", "--no-rings", "--shear", "0.05")
    outcome = uvshear("bias", "--estimator", "metacal", *QUICK, *words, "-o", output)
    assert outcome.status == 0, outcome.err
    record = json.loads(output.read_text())
    assert (record["estimator"], record["wraps"]) == ("metacal", "moments")
    assert abs(record["m1"]) < 0.03


@pytest.mark.long
def test_a_crowd_is_calibrated(uvshear: Callable, tmp_path: Path) -> None:
    output = tmp_path / "bias.json"
    words = ("--galaxies", "100", "--density", "8", "--integration-s", "14400", "--shear", "0")
    outcome = uvshear("bias", "--estimator", "mean", *words, "--threads", "2", "-o", output)
    assert outcome.status == 0, outcome.err
    record = json.loads(output.read_text())
    assert record["density"] == 8.0
    assert record["n"] + record["failed"] <= 100
    assert abs(record["c1"]) < 0.2
