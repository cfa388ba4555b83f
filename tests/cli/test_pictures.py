import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

from uvshear.cli import demo


def test_the_known_arrays_are_listed(uvshear: Callable) -> None:
    outcome = uvshear("layouts")
    assert outcome.status == 0
    for name in [
        "ska-mid-aa4",
        "ska-mid-aastar",
        "ska-mid-aa2",
        "meerkat",
        "vla-a",
        "vla-b",
        "e-merlin",
    ]:
        assert name in outcome.out


def test_one_array_is_drawn(
    uvshear: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = uvshear("layouts", "vla-a")
    assert outcome.status == 0
    assert "27" in outcome.out
    assert [path.name for path in tmp_path.iterdir()] == ["vla-a-layout.png"]


def test_the_psf_is_described_and_drawn(
    uvshear: Callable, tmp_path: Path, field: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = uvshear("psf", field, "--weight-sigma-arcsec", "8", "--pixel-arcsec", "0.5")
    assert outcome.status == 0, outcome.err
    assert "size Q_ll + Q_mm, Gaussian weight" in outcome.out
    assert "weighted" not in outcome.out
    assert (tmp_path / "field-psf.png").exists()
    assert (tmp_path / "field-uv.png").exists()


def test_what_a_weighting_makes_of_the_psf_is_told(
    uvshear: Callable, tmp_path: Path, catalogue: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = "--layout meerkat --declination-deg 10 --hours 4 --integration-s 600 --band-mhz 950 1190 --no-noise"
    simulated = uvshear("simulate", *words.split(), "--catalogue", catalogue, "-o", "field.ms")
    assert simulated.status == 0, simulated.err
    sigma = ["--weight-sigma-arcsec", "4", "--pixel-arcsec", "0.5", "--scale-length-arcsec", "4"]
    weighting = "--weight briggs --robust 1 --taper-gaussian-arcsec 6 --round-psf"
    outcome = uvshear("psf", "field.ms", *sigma, *weighting.split())
    assert outcome.status == 0, outcome.err
    (line,) = (
        line
        for line in outcome.out.splitlines()
        if "relative information (1/variance) on e1" in line
    )
    natural, weighted = (float(word) for word in line.split()[-2:])
    assert natural == 1
    assert 0.3 < weighted < 1
    (line,) = (
        line for line in outcome.out.splitlines() if line.strip().startswith("e1, Gaussian weight")
    )
    natural, weighted = (float(word) for word in line.split()[-2:])
    assert abs(weighted) < min(0.005, abs(natural) / 3)


def test_what_baselines_cannot_tell_is_said(
    uvshear: Callable, tmp_path: Path, field: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = uvshear("psf", field, "--uv-min", "10", "--scale-length-arcsec", "9000")
    assert outcome.status == 0, outcome.err
    assert "the shape information: the weighted baselines do not determine the shape" in outcome.err
    assert "1/variance" not in outcome.out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("psf field.ms --weight briggs", "--weight briggs: --robust is required"),
        ("psf field.ms --robust 1", "--robust 1: --robust applies only to --weight briggs"),
        ("psf field.ms --taper-tukey 100", "the taper ends at --uv-max, which must be given"),
        (
            "psf field.ms --taper-inner-tukey 100",
            "the taper begins at --uv-min, which must be given",
        ),
        (
            "psf field.ms --weight-sigma-arcsec 0",
            "--weight-sigma-arcsec': 0; a number above 0 is needed",
        ),
        ("psf field.ms --weight-field-arcmin 3", "--weight uniform or briggs is needed"),
        ("psf field.ms --scale-length-arcsec 3", "or give a weighting or a uv range"),
        ("psf field.ms --uv-max 500 --taper-tukey 600", "the tapers are longer than the uv range"),
        ("psf field.ms --uv-min 1e9 --weight briggs --robust 0", "or another weighting, is needed"),
        ("psf field.ms --uv-min 1e9 --weight uniform", "or another weighting, is needed"),
        ("psf field.ms --uv-min 1e9", "a wider uv range, or another weighting, is needed"),
        ("psf field.ms --uv-min 10 --uv-max 5", "uv-min < uv-max is needed"),
        ("psf field.ms --pixel-arcsec -1", "-1; a number above 0 is needed"),
        ("psf field.ms --pixel-arcsec 3", "give pixels of about sigma/5"),
        ("psf absent.ms", "absent.ms"),
        ("psf field.ms -o nowhere/psf.png", "does not exist"),
        ("layouts alma", "neither a known array"),
        ("layouts vla-a -o map.docx", "extension"),
        ("demo cat.ecsv", "is a file; a directory is needed"),
        ("demo /proc/demo", "cannot be created"),
        ("demo full", "exists already; give --overwrite or another directory"),
    ],
)
def test_a_wrong_input_is_named_and_nothing_written(
    uvshear: Callable,
    tmp_path: Path,
    field: Path,
    monkeypatch: pytest.MonkeyPatch,
    words: str,
    message: str,
) -> None:
    assert field.exists()
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "shapes.fits").write_text("kept")
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    outcome = uvshear(*words.split())
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


def test_the_demo_runs_commands_that_a_user_can_type(
    uvshear: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The demo on a small field: fewer galaxies, a smaller array, fewer samples."""
    smaller = {"2.8": "0.3", "ska-mid-aa4": "meerkat", str(demo.INTEGRATION_S): "3600"}
    whole = demo.commands
    monkeypatch.setattr(
        demo,
        "commands",
        lambda directory: tuple(
            tuple(smaller.get(word, word) for word in command) for command in whole(directory)
        ),
    )
    directory = tmp_path / "new" / "demo"
    outcome = uvshear("demo", directory)
    assert outcome.status == 0, outcome.err
    names = {path.name for path in directory.iterdir()}
    assert names == {
        *demo.FILES,
        *(f"{picture}.png" for picture in demo.PICTURES),
    }
    quoted = [
        "slope of e, weights 1/s^2 with s the error of e (probably those of Rivi & Miller 2018)",
        "effective number of galaxies",
        "slope of e, weights 1/(s^2 + 0.07)",
        "slope of e, unweighted",
        "true shear",
        "shear by moments",
        "shear by mean",
    ]
    places = [outcome.out.index(line) for line in quoted]
    assert places == sorted(places)
    for name, estimator in ((demo.SHEAR, "moments"), (demo.SHEAR_OF_THE_MEAN, "mean")):
        found = json.loads((directory / name).read_text())
        assert found["estimator"] == estimator
        for component, true in (("g1", demo.TRUE_SHEAR.real), ("g2", demo.TRUE_SHEAR.imag)):
            assert abs(found[component] - true) < 4 * found[f"{component}_err"]
    slopes = Table.read(directory / demo.SLOPES)
    assert slopes["component"].tolist() == ["e1", "e2"]
    for first, others in (("slope", "slope_population"), ("slope_population", "slope_unweighted")):
        assert slopes.colnames.index(first) < slopes.colnames.index(others)
    # Few galaxies before a small array: the wrong sign of a component, or of the shear's frame, is far from 1.
    assert np.all(np.abs(slopes["slope"] - 1) < 0.15)
    assert np.all((slopes["effective_galaxies"] >= 1) & (slopes["effective_galaxies"] < 12))
    assert uvshear("demo", directory).status == 2
