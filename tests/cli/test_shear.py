import json
from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import astropy.units as u
import numpy as np
import pytest
from astropy.table import Table

from tests.estimators.test_evidence import POPULATION, Toy
from tests.estimators.test_population_fit import toy_likelihoods
from uvshear import __version__
from uvshear.estimators import Bayesian, Metacal
from uvshear.estimators.packing import PACKED, pack, unpack
from uvshear.geometry.directions import PhaseCentre
from uvshear.geometry.ellipticity import add_shear
from uvshear.io.shapes import COLUMNS, DERIVED, shapes_table, write_shapes
from uvshear.io.statistics import (
    read_statistics,
    statistics_path,
    statistics_table,
    write_statistics,
)

REMARK = "noise biases the mean of ellipticities"


@pytest.fixture
def shapes(tmp_path: Path) -> Path:
    """Two hundred shapes of mean ellipticity 0.05 - 0.02i at the phase centre, where local North is the m axis."""
    rng = np.random.default_rng(8)
    n = 200
    values = {name: rng.uniform(0.01, 0.02, n) for name in COLUMNS if name not in DERIVED}
    values |= {
        "id": np.arange(n),
        "l": np.zeros(n),
        "m": np.zeros(n),
        "e1": rng.normal(0.05, 0.1, n),
        "e2": rng.normal(-0.02, 0.1, n),
        "weight": np.ones(n),
        "snr": np.linspace(5, 50, n),
        "flag": np.full(n, "ok"),
    }
    path = tmp_path / "shapes.fits"
    write_shapes(path, shapes_table(values, PhaseCentre(0.0, 0.0)))
    return path


def test_the_shear_is_told_and_written(uvshear: Callable, tmp_path: Path, shapes: Path) -> None:
    output = tmp_path / "shear.json"
    outcome = uvshear("shear", shapes, "-o", output)
    assert outcome.status == 0, outcome.err
    estimate = json.loads(output.read_text())
    names = ["g1", "g1_err", "g2", "g2_err", "n", "estimator", "frame"]
    made = ["version", "command", "inputs", "options", "date"]
    rest = ["cuts", "seed", "calibration", "goodness", "remarks", "bins"]
    assert list(estimate) == [*names, *made, *rest]
    assert (estimate["goodness"], estimate["remarks"]) == (None, [])
    assert estimate["frame"] == "sky"
    assert estimate["command"] == "uvshear shear"
    assert estimate["inputs"] == [str(shapes)]
    assert estimate["options"]["estimator"] == "mean"
    assert estimate["cuts"] == {"snr_min": 0.0, "detection_min": 0.0, "flux_min_ujy": 0.0}
    assert estimate["seed"] == 1
    assert datetime.fromisoformat(estimate["date"]).utcoffset() is not None
    assert estimate["calibration"] is None
    assert estimate["n"] == 200
    assert estimate["estimator"] == "mean"
    assert estimate["version"] == __version__
    assert abs(estimate["g1"] - 0.05) < 4 * estimate["g1_err"]
    # In the frame of local North the second component has the opposite sign of e2.
    assert abs(estimate["g2"] - 0.02) < 4 * estimate["g2_err"]
    assert estimate["g1_err"] == pytest.approx(0.1 / np.sqrt(200), rel=0.15)
    assert f"g1 = {estimate['g1']:+.5f}" in outcome.out


def test_faint_galaxies_are_left_out(uvshear: Callable, tmp_path: Path, shapes: Path) -> None:
    output = tmp_path / "shear.json"
    assert uvshear("shear", shapes, "--snr-min", "27.5", "-o", output).status == 0
    assert json.loads(output.read_text())["n"] == 100


def test_a_shuffled_table_gives_the_same_shear_and_error(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    table = Table.read(shapes)
    shuffled = tmp_path / "shuffled.fits"
    table[np.random.default_rng(5).permutation(len(table))].write(shuffled)
    found = []
    for path in (shapes, shuffled):
        output = tmp_path / f"{path.stem}.json"
        assert uvshear("shear", path, "-o", output).status == 0
        found.append(json.loads(output.read_text()))
    for name in ("g1", "g1_err", "g2", "g2_err"):
        assert found[0][name] == pytest.approx(found[1][name], rel=1e-10)


def test_errors_may_come_from_patches(uvshear: Callable, tmp_path: Path, shapes: Path) -> None:
    table = Table.read(shapes)
    rng = np.random.default_rng(6)
    table["l"], table["m"] = rng.uniform(-1e-3, 1e-3, (2, len(table)))
    table.write(shapes, overwrite=True)
    output = tmp_path / "shear.json"
    assert uvshear("shear", shapes, "--patches", "20", "-o", output).status == 0
    estimate = json.loads(output.read_text())
    assert estimate["options"]["patches"] == 20
    assert estimate["g1_err"] == pytest.approx(0.1 / np.sqrt(200), rel=0.5)
    outcome = uvshear("shear", shapes, "--patches", "201")
    assert outcome.status == 2
    assert "201 patches of the sky for 200 sources" in outcome.err


@pytest.mark.parametrize(
    ("name", "words", "message"),
    [
        ("absent.fits", "", "absent.fits: no such file"),
        ("junk.fits", "", "cannot be read as a table"),
        ("other.csv", "", "has no column 'e1'; a table written by `uvshear measure` is needed"),
        (
            "placeless.fits",
            "",
            "placeless.fits: lacks its phase centre (ra0_deg and dec0_deg in its",
        ),
        (
            "shapes.fits",
            "--estimator spin",
            "--estimator spin: 'spin' is not a known estimator; the known names are mean,",
        ),
        (
            "shapes.fits",
            "--estimator absent:Mine",
            "the estimator 'absent:Mine' cannot be imported",
        ),
        ("shapes.fits", "--snr-min -3", "'--snr-min': -3; a number of 0 or more is needed"),
        ("shapes.fits", "--snr-min 1e9", "2 or more are needed"),
        ("shapes.fits", "--seed -3", "--seed"),
    ],
)
def test_a_wrong_input_is_named_and_nothing_written(
    uvshear: Callable, tmp_path: Path, shapes: Path, name: str, words: str, message: str
) -> None:
    (shapes.parent / "junk.fits").write_bytes(b"\x01\x02" * 50)
    (shapes.parent / "other.csv").write_text("a,b\n1,2\n")
    placeless = Table.read(shapes)
    placeless.meta.clear()
    placeless.write(shapes.parent / "placeless.fits")
    before = sorted(tmp_path.iterdir())
    outcome = uvshear("shear", tmp_path / name, *words.split(), "-o", tmp_path / "shear.json")
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.fixture
def kept(shapes: Path) -> Path:
    """Moments beside the shapes: of shear 0.04, 0.03 in the sky frame, without noise of their own."""
    rng = np.random.default_rng(9)
    n = 200
    response = rng.uniform(1, 2, n)
    table = Table({"id": np.arange(n)})
    values = {"m1": 0.04 * response, "m2": -0.03 * response, "m_size": response}
    # K = R/2: no third order is left in the ratio
    values |= {"r11": response, "r12": 0 * response, "r22": response, "r_third": response / 2}
    values |= {"m1_var": np.ones(n), "m2_var": np.ones(n), "m12_cov": np.zeros(n)}
    for name, column in values.items():
        table[name] = column
    write_statistics(statistics_path(shapes), table, {})
    return shapes


def test_moments_kept_become_a_shear(uvshear: Callable, tmp_path: Path, kept: Path) -> None:
    output = tmp_path / "shear.json"
    assert uvshear("shear", kept, "--estimator", "moments", "-o", output).status == 0
    estimate = json.loads(output.read_text())
    assert estimate["estimator"] == "moments"
    assert estimate["n"] == 200
    assert estimate["g1"] == pytest.approx(0.04)
    assert estimate["g2"] == pytest.approx(0.03)


def test_metacalibrated_ellipticities_become_a_shear(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    """Behind 0.04, 0.03, with a response that is not symmetric; half of the galaxies have none."""
    rng = np.random.default_rng(9)
    response = np.array([[0.5, 0.1], [-0.05, 0.6]]) * rng.uniform(1, 2, (200, 1, 1))
    value = response @ np.array([0.04, -0.03])
    table = Table({"id": np.arange(200)})
    numbers = np.column_stack([value, response.reshape(200, 4)])
    numbers[::2] = np.nan
    for name, column in zip(Metacal.columns, numbers.T, strict=True):
        table[name] = column
    write_statistics(statistics_path(shapes), table, {})
    output = tmp_path / "shear.json"
    assert uvshear("shear", shapes, "--estimator", "metacal", "-o", output).status == 0
    estimate = json.loads(output.read_text())
    assert (estimate["estimator"], estimate["n"]) == ("metacal", 100)
    assert estimate["g1"] == pytest.approx(0.04)
    assert estimate["g2"] == pytest.approx(0.03)


def test_moments_that_were_not_kept_are_asked_for(uvshear: Callable, shapes: Path) -> None:
    outcome = uvshear("shear", shapes, "--estimator", "moments")
    assert outcome.status == 2
    assert "measure again with --keep moments" in outcome.err


def test_moments_of_another_table_are_refused(uvshear: Callable, kept: Path) -> None:
    path = statistics_path(kept)
    write_statistics(path, Table.read(path)[:-1], {}, overwrite=True)
    outcome = uvshear("shear", kept, "--estimator", "moments")
    assert outcome.status == 2
    assert "has no source 199, which" in outcome.err


@pytest.fixture
def likely(shapes: Path) -> Path:
    """Likelihoods beside the shapes: of galaxies behind a shear of 0.05, 0; some have none."""
    rng = np.random.default_rng(3)
    modulus = POPULATION.ellipticity.draw_modulus(75, rng)
    intrinsic = modulus * np.exp(2j * np.pi * rng.uniform(size=75))
    lensed = add_shear(np.concatenate([intrinsic, -intrinsic]), 0.05 + 0j)
    kept = {
        k: pack(Toy(complex(e), 0.06, size=0.0).on_lattice())
        for k, e in enumerate(lensed, start=30)
    }
    _keep(shapes, kept)
    return shapes


def _keep(shapes: Path, kept: dict) -> None:
    """Put likelihoods beside the shapes, by the number of the row."""
    table = statistics_table(Table.read(shapes), [Bayesian()], kept)
    write_statistics(statistics_path(shapes), table, {}, overwrite=True)


def test_likelihoods_kept_become_a_shear(uvshear: Callable, tmp_path: Path, likely: Path) -> None:
    output = tmp_path / "shear.json"
    outcome = uvshear("shear", likely, "--estimator", "bayesian", "-o", output)
    assert outcome.status == 0, outcome.err
    estimate = json.loads(output.read_text())
    assert estimate["estimator"] == "bayesian"
    assert estimate["n"] == 150
    assert 0.003 < estimate["g1_err"] < 0.03
    # rings of shapes without noise: nearer than the error
    assert abs(estimate["g1"] - 0.05) < 0.5 * estimate["g1_err"]
    assert abs(estimate["g2"]) < 0.5 * estimate["g2_err"]


def test_a_population_that_does_not_fit_is_told(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    """These galaxies are half as large as the paper's."""
    rng = np.random.default_rng(9)
    e = 0.2 * (rng.normal(size=110) + 1j * rng.normal(size=110))
    size = np.log(0.5) + POPULATION.size.sigma * rng.normal(size=110)
    _keep(
        shapes,
        {
            k: pack(Toy(complex(a), 0.05, size=float(b), size_sigma=0.05, slope=0).on_lattice())
            for k, (a, b) in enumerate(zip(e, size, strict=True))
        },
    )
    output = tmp_path / "shear.json"
    outcome = uvshear("shear", shapes, "--estimator", "bayesian", "-o", output)
    assert outcome.status == 0
    estimate = json.loads(output.read_text())
    (remark,) = estimate["remarks"]
    assert f"uvshear: note: {remark}" in outcome.err
    assert "does not fit these galaxies: their sizes are about 0.5" in remark
    assert estimate["goodness"]["size"]["median_log_shift"] == pytest.approx(np.log(0.5), abs=0.1)
    assert estimate["goodness"]["n"] == 110


@pytest.mark.long
def test_a_fitted_population_is_told_and_can_be_given_again(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    likelihoods = toy_likelihoods(150, np.random.default_rng(4), 0.05 + 0j)
    _keep(shapes, {k: pack(likelihood) for k, likelihood in enumerate(likelihoods)})

    def found(name: str, prior: str | Path) -> tuple[dict, str]:
        output = tmp_path / name
        words = ("--estimator", "bayesian", "--prior", prior, "-o", output)
        outcome = uvshear("shear", shapes, *words)
        assert outcome.status == 0, outcome.err
        return json.loads(output.read_text()), outcome.out

    paper, _ = found("paper.json", "paper")
    assert (paper["prior"], paper["population"]["size"]["intercept"]) == ("paper", -0.93)
    fitted, told = found("fitted.json", "fitted")
    size = fitted["population"]["size"]
    assert fitted["prior"] == "fitted"
    assert abs(size["intercept"] + 0.78) < 3 * size["intercept_err"] < 0.15
    assert f"size intercept = {size['intercept']:.3f} +- {size['intercept_err']:.3f}" in told
    again, _ = found("again.json", tmp_path / "fitted.json")
    assert again["prior"] == "file"
    # at the fit the scores add up to zero
    assert abs(again["goodness"]["size"]["median_log_shift"]) < 0.02
    assert paper["goodness"]["size"]["median_log_shift"] > 0.05
    assert "size" not in fitted["goodness"]
    assert fitted["remarks"] == again["remarks"] == []
    assert again["g1"] == pytest.approx(fitted["g1"], abs=1e-12)
    assert abs(again["g1"] - paper["g1"]) > 1e-3


def test_a_prior_that_is_none_is_named(uvshear: Callable, likely: Path) -> None:
    outcome = uvshear("shear", likely, "--estimator", "bayesian", "--prior", "fited")
    assert outcome.status == 2
    assert "--prior fited: is neither 'paper' nor 'fitted' nor an existing file" in outcome.err


def test_a_population_that_is_the_output_too_is_refused(
    uvshear: Callable, tmp_path: Path, likely: Path
) -> None:
    path = tmp_path / "population.json"
    path.write_text('{"size": {"sigma": 0.4}}')
    words = ("--estimator", "bayesian", "--prior", path, "-o", path, "--overwrite")
    outcome = uvshear("shear", likely, *words)
    assert outcome.status == 2
    assert "is an input too" in outcome.err
    assert path.read_text() == '{"size": {"sigma": 0.4}}'


def _calibration(path: Path, **changed: object) -> Path:
    record = {"m1": -0.1, "m1_err": 0.01, "m2": 0.0, "m2_err": 0.0, "c1": 1e-3, "c1_err": 1e-3}
    record |= {"c2": 0.0, "c2_err": 0.0, "n": 10, "snr_min": 0.0}
    record |= {"estimator": "mean", "frame": "sky"} | changed
    path.write_text(
        json.dumps({name: value for name, value in record.items() if value is not None})
    )
    return path


def test_a_calibration_is_applied(uvshear: Callable, tmp_path: Path, shapes: Path) -> None:
    bias = _calibration(tmp_path / "bias.json")
    for name, words in (("raw", ()), ("calibrated", ("--calibration", bias))):
        assert uvshear("shear", shapes, *words, "-o", tmp_path / f"{name}.json").status == 0
    raw, calibrated = (
        json.loads((tmp_path / f"{name}.json").read_text()) for name in ("raw", "calibrated")
    )
    assert calibrated["g1"] == pytest.approx((raw["g1"] - 1e-3) / 0.9)
    assert calibrated["g1_err"] > raw["g1_err"] / 0.9
    assert calibrated["g2"] == raw["g2"]
    assert calibrated["calibration"] == str(bias)


def test_a_bias_of_version_0_1_0_has_the_other_sign_of_c2(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    """Its file does not name a frame: it is that of (l, m)."""
    found = {}
    for name, changed in (("sky", {"c2": 2e-3}), ("old", {"c2": -2e-3, "frame": None})):
        bias = _calibration(tmp_path / "bias.json", **changed)
        output = tmp_path / f"{name}.json"
        assert uvshear("shear", shapes, "--calibration", bias, "-o", output).status == 0
        found[name] = json.loads(output.read_text())
    for component in ("g1", "g2"):
        assert found["old"][component] == found["sky"][component]
    assert uvshear("shear", shapes, "-o", tmp_path / "raw.json").status == 0
    raw = json.loads((tmp_path / "raw.json").read_text())
    assert found["sky"]["g2"] == pytest.approx(raw["g2"] - 2e-3, abs=1e-12)


def test_the_bias_of_the_mean_is_told_unless_it_is_removed(
    uvshear: Callable, tmp_path: Path, shapes: Path, kept: Path
) -> None:
    told = uvshear("shear", shapes).err
    assert REMARK in told
    assert "`--estimator moments` and `--estimator bayesian`" in told
    bias = _calibration(tmp_path / "bias.json")
    assert REMARK not in uvshear("shear", shapes, "--calibration", bias).err
    assert uvshear("shear", kept, "--estimator", "moments").err == ""


def test_the_papers_facets_have_a_calibration_of_their_own(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    table = Table.read(shapes)
    table.meta["extract"] = json.dumps({"extraction": "paper", "averages_cells": True})
    table.write(shapes, overwrite=True)
    bias = _calibration(tmp_path / "bias.json", facet="cell-average")
    assert uvshear("shear", shapes, "--calibration", bias).status == 0
    outcome = uvshear("shear", shapes, "--calibration", _calibration(tmp_path / "exact.json"))
    assert outcome.status == 2
    assert (
        "simulated with facet = exact, but the shapes were measured with facet = cell-av"
        in outcome.err
    )


def test_a_cut_that_is_only_nearly_the_biass_is_told(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    for selection, lines in (("catalogue", 1), ("measured", 0)):
        bias = _calibration(tmp_path / "bias.json", snr_min=20.0, selection=selection)
        outcome = uvshear("shear", shapes, "--snr-min", "20", "--calibration", bias)
        assert outcome.status == 0
        assert len(outcome.err.splitlines()) == lines
        assert (
            "were selected by the signal-to-noise ratio of their catalogue flux" in outcome.err
        ) == bool(lines)


def test_a_bias_of_another_population_is_refused(
    uvshear: Callable, tmp_path: Path, likely: Path
) -> None:
    own = tmp_path / "own.json"
    own.write_text('{"size": {"sigma": 0.35}}')
    words = ("--estimator", "bayesian", "--prior", own, "--calibration")
    for sigma, status in ((0.35, 0), (0.4, 2)):
        population = {"size": {"sigma": sigma}}
        bias = _calibration(
            tmp_path / "bias.json", estimator="bayesian", prior="file", population=population
        )
        outcome = uvshear("shear", likely, *words, bias)
        assert outcome.status == status, outcome.err
    assert (
        "its population has size sigma = 0.4, but the population assumed for the shear has 0.35"
        in outcome.err
    )


def test_a_bin_that_the_population_does_not_have_is_left_out(
    uvshear: Callable, tmp_path: Path, likely: Path
) -> None:
    """Likelihoods are of galaxies of 20 uJy; the catalogue says 10 to 20 of some."""
    table = Table.read(likely)
    table["flux"] = np.where(np.arange(200) < 100, 15.0, 30.0) * u.uJy
    table.write(likely, overwrite=True)
    kept = read_statistics(statistics_path(likely), likely, table)
    bright = {
        k: unpack(dict(zip(PACKED, kept[k][list(PACKED)], strict=True))) for k in range(100, 180)
    }
    bright = {k: replace(likelihood, flux=3 * likelihood.flux) for k, likelihood in bright.items()}
    faint = pack(Toy(0.1 + 0j, 0.06, size=0.0).on_lattice())
    _keep(likely, dict.fromkeys(range(50), faint) | {k: pack(part) for k, part in bright.items()})
    population = tmp_path / "population.json"
    population.write_text('{"flux": {"minimum_ujy": 40}}')
    output = tmp_path / "shear.json"
    words = ("--estimator", "bayesian", "--prior", population, "-o", output)
    outcome = uvshear("shear", likely, *words)
    assert outcome.status == 0, outcome.err
    found = json.loads(output.read_text())
    assert [part["flux"] for part in found["bins"]] == ["20-50 uJy"]
    assert found["n"] == found["bins"][0]["n"] == 80


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("flux", ("--flux-min-ujy", "20")),
        ("flux", ("--estimator", "moments")),
        ("id", ("--estimator", "moments")),
    ],
)
def test_a_column_that_is_needed_is_named(
    uvshear: Callable, kept: Path, column: str, words: tuple[str, ...]
) -> None:
    table = Table.read(kept)
    table.remove_column(column)
    table.write(kept, overwrite=True)
    outcome = uvshear("shear", kept, *words)
    assert outcome.status == 2
    assert f"has no column '{column}'" in outcome.err
    assert len(outcome.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            {"estimator": "moments"},
            "was simulated with estimator = moments, but the shear is estimated with estimator = mean",
        ),
        ({"snr_min": 10.0}, "with snr_min = 10, but the shear is estimated with snr_min = 0"),
        ({"flux_min_ujy": 25.0}, "with flux_min_ujy = 25, but the shear is estimated with"),
        ({"prior": "fitted"}, "with prior = fitted, but the shear is estimated with prior = paper"),
        ({"facet": "cell-average"}, "with facet = cell-average, but the shapes were measured with"),
        ({"position_error_arcsec": 0.5}, "was simulated with `--position-error-arcsec`"),
        ({"legacy_shear": True}, "was simulated with `--legacy-shear`"),
        ({"wraps": "moments"}, "was simulated with wraps = moments"),
        ({"frame": "lm"}, "is in the frame 'lm'; the frame 'sky' is needed"),
        ({"flux_max_ujy": 50.0}, "was simulated with an upper limit of the flux, 50 uJy"),
        ({"m2": -1.5}, "m is -1 or less"),
        ({"m1": None}, "lacks m, c or their errors"),
        ("[1, 2]", "is not a file written by `uvshear bias`"),
        ("{", "cannot be read as JSON"),
        (None, "no such file"),
    ],
)
def test_a_wrong_calibration_is_named(
    uvshear: Callable, tmp_path: Path, shapes: Path, content: object, message: str
) -> None:
    path = tmp_path / "bias.json"
    if isinstance(content, dict):
        _calibration(path, **content)
    elif isinstance(content, str):
        path.write_text(content)
    outcome = uvshear("shear", shapes, "--calibration", path, "-o", tmp_path / "shear.json")
    assert outcome.status == 2
    assert message in outcome.err
    assert not (tmp_path / "shear.json").exists()


def test_bins_of_flux_share_the_galaxies(uvshear: Callable, tmp_path: Path, shapes: Path) -> None:
    table = Table.read(shapes)
    table["flux"] = np.geomspace(10, 199, len(table)) * (1e-6 * u.Jy).to(table["flux"].unit).value
    table.write(shapes, overwrite=True)
    output = tmp_path / "shear.json"
    assert uvshear("shear", shapes, "--flux-min-ujy", "12", "-o", output).status == 0
    estimate = json.loads(output.read_text())
    assert [part["flux"] for part in estimate["bins"]] == ["10-20 uJy", "20-50 uJy", "50-200 uJy"]
    flux = np.geomspace(10, 199, 200)
    expected = [int(((flux >= a) & (flux < b)).sum()) for a, b in ((12, 20), (20, 50), (50, 200))]
    assert [part["n"] for part in estimate["bins"]] == expected
    assert estimate["n"] == sum(expected)


def test_likelihoods_of_no_source_are_no_shear(uvshear: Callable, shapes: Path) -> None:
    _keep(shapes, {})
    outcome = uvshear("shear", shapes, "--estimator", "bayesian")
    assert outcome.status == 2
    assert "fewer than 2 contribute to the shear" in outcome.err


def test_statistics_of_other_sources_are_refused(uvshear: Callable, kept: Path) -> None:
    path = statistics_path(kept)
    table = Table.read(path)
    write_statistics(path, table, {"run": "another"}, overwrite=True)
    outcome = uvshear("shear", kept, "--estimator", "moments")
    assert outcome.status == 2
    assert "belongs to another measurement than" in outcome.err


def test_a_table_without_fluxes_has_a_shear_and_no_bins(
    uvshear: Callable, tmp_path: Path, shapes: Path
) -> None:
    table = Table.read(shapes)
    table.remove_column("flux")
    table.write(shapes, overwrite=True)
    output = tmp_path / "shear.json"
    assert uvshear("shear", shapes, "-o", output).status == 0
    assert json.loads(output.read_text())["bins"] == []


def test_a_prior_is_for_the_estimator_that_has_one(uvshear: Callable, shapes: Path) -> None:
    outcome = uvshear("shear", shapes, "--prior", "fitted")
    assert outcome.status == 2
    assert "--estimator mean has no prior; only bayesian has one" in outcome.err
