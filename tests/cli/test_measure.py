import json
import shutil
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from astropy import units
from astropy.io import fits
from astropy.table import Table
from casacore import tables

import uvshear as package
from tests.io.measurement_sets import real_set
from uvshear.cli.extractions import ExtractionChoice, FacetName
from uvshear.estimators.packing import PACKED, unpack
from uvshear.extraction import ConvergedExtraction, PaperExtraction
from uvshear.extraction.paper.cell_average import CellAverageFacets, PaperTable, ScaleLengths
from uvshear.extraction.paper.exact import ExactFacets
from uvshear.io.shapes import COLUMNS, read_shapes
from uvshear.io.statistics import read_statistics, statistics_path

CONTRACT = 21
"""Columns that commands.md fixes, the first of the table."""


def test_shapes_are_measured_and_tell_how(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output, "--uv-min", "10")
    assert outcome.status == 0, outcome.err
    assert all("has not converged" in line for line in outcome.err.splitlines())
    shapes = read_shapes(output)
    assert shapes.colnames[:CONTRACT] == list(COLUMNS)[:CONTRACT]
    assert shapes["id"].tolist() == [1, 2, 3]
    assert json.loads(shapes.meta["INPUTS"]) == [str(field), str(catalogue)]
    options = json.loads(shapes.meta["OPTIONS"])
    assert options["uv_min"] == 10.0
    assert not {"threads", "overwrite", "output"} & set(options)
    assert shapes.meta["VERSION"] == f"uvshear {package.__version__}"
    assert shapes.meta["COMMAND"] == "uvshear measure"
    assert datetime.fromisoformat(shapes.meta["DATE"]).utcoffset() is not None


def test_two_sets_of_a_pointing_are_measured_together(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    copy = tmp_path / "copy.ms"
    shutil.copytree(field, copy)
    snr = []
    for name, sets in (("one.ecsv", [field]), ("two.ecsv", [field, copy])):
        words = ("measure", *sets, "--catalogue", catalogue, "-o", tmp_path / name)
        assert uvshear(*words, "--extraction", "paper").status == 0
        snr.append(np.asarray(read_shapes(tmp_path / name)["snr"]))
    np.testing.assert_allclose(snr[1] / snr[0], np.sqrt(2), rtol=0.05)


def test_extraction_and_facets_are_chosen_by_name_and_size() -> None:
    exact, cells = FacetName.EXACT, FacetName.CELL_AVERAGE

    def chosen(name: str, *options: Any) -> package.Extraction:
        return ExtractionChoice(name, *options).extraction()

    for facet in (None, exact):
        assert chosen("converged", facet) == ConvergedExtraction()
    # A uv-min that is asked for is taken at its word, 0 too.
    assert chosen("converged", None, None, None, 0.0) == ConvergedExtraction(shortest=0.0)
    assert chosen("converged", None, 60.0) == ConvergedExtraction(scale_lengths=60.0)
    for facet in (None, cells):
        assert chosen("paper", facet) == PaperExtraction(CellAverageFacets(PaperTable()), passes=1)
    assert chosen("paper", cells, 76.0, 3) == PaperExtraction(
        CellAverageFacets(ScaleLengths(76)), passes=3
    )
    assert chosen("paper", exact) == PaperExtraction(ExactFacets())
    assert chosen("paper", exact, 80.0) == PaperExtraction(ExactFacets(80.0))


def test_extraction_and_memory_reach_the_measurement(
    uvshear: Callable,
    tmp_path: Path,
    field: Path,
    catalogue: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard: list[tuple[PaperExtraction, float]] = []
    extract = PaperExtraction.extract

    def listening(self: PaperExtraction, seen: Any, field: Any, setting: Any, *more: Any) -> Any:
        heard.append((self, setting.resources.memory))
        return extract(self, seen, field, setting, *more)

    monkeypatch.setattr(PaperExtraction, "extract", listening)
    output = tmp_path / "shapes.fits"
    words = ("measure", field, "--catalogue", catalogue, "-o", output)
    more = ("--extraction", "paper", "--memory-gb", "1.5")
    assert uvshear(*words, *more).status == 0
    assert heard == [(PaperExtraction(), 1.5e9)]
    meta = read_shapes(output).meta
    assert json.loads(meta["EXTRACT"])["facet"] == "CellAverageFacets"
    assert json.loads(meta["OPTIONS"])["extraction"] == "paper"


@pytest.mark.parametrize("extraction", ["converged", "paper"])
def test_what_is_left_is_imaged_and_drawn(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, extraction: str
) -> None:
    image = tmp_path / "left.fits"
    words = ("measure", field, "--catalogue", catalogue, "-o", tmp_path / "shapes.fits")
    outcome = uvshear(*words, "--extraction", extraction, "--residual-image", image)
    assert outcome.status == 0, outcome.err
    assert f"{image}, {tmp_path / 'left.png'}: the rms of the residual is" in outcome.out
    assert (tmp_path / "left.png").read_bytes().startswith(b"\x89PNG")
    with fits.open(image) as hdus:
        residual, dirty = (hdu.header for hdu in hdus)
        assert (
            residual["RMS"] < 0.1 * dirty["RMS"]
        )  # beams overlap, and four antennas do not tell all
        assert json.loads(residual["INPUTS"]) == [str(field), str(catalogue)]
    assert "residual_image" not in json.loads(read_shapes(tmp_path / "shapes.fits").meta["OPTIONS"])


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("left.png", "give a name that ends in .fits"),
        ("there.fits", "there.fits: exists already; give --overwrite"),
        ("drawn.fits", "drawn.png: exists already; give --overwrite"),
        ("nowhere/left.fits", "does not exist"),
        ("shapes.fits", "would be written twice"),
        ("shapes.sky.fits", "would be written twice"),
    ],
)
def test_an_image_that_cannot_be_written_is_refused_before_measuring(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, name: str, message: str
) -> None:
    for there in ("there.fits", "drawn.png"):
        (tmp_path / there).write_text("kept")
    before = sorted(tmp_path.iterdir())
    words = ("measure", field, "--catalogue", catalogue, "-o", tmp_path / "shapes.fits")
    outcome = uvshear(*words, "--residual-image", tmp_path / name)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--uv-min -1", "'--uv-min': -1; a number of 0 or more is needed"),
        ("--uv-min nan", "'--uv-min': nan; a number of 0 or more is needed"),
        ("--uv-max 0", "'--uv-max': 0; a number above 0 is needed"),
        ("--uv-min 5000 --uv-max 3000", "--uv-min 5000 --uv-max 3000: uv-min < uv-max"),
        ("--facet-size -38", "'--facet-size': -38; a number above 0 is needed"),
        ("--extraction paper --passes 0", "'--passes': 0; a number above 0 is needed"),
        (
            "--passes 3",
            "--extraction converged --passes 3: the converged extraction iterates to convergence",
        ),
        ("--facet cell-average", "--facet cell-average: the converged extraction has exact facets"),
        (
            "--extraction both",
            "--extraction both: 'both' is not a known extraction; the known names are converged, paper,",
        ),
        (
            "--profile square",
            "--profile square: 'square' is not a known profile; the known names are exponential, gaussian, sersic-2,",
        ),
        ("--profile absent:Round", "--profile absent:Round: the profile 'absent:Round' cannot be"),
        (
            "--primary-beam round",
            "--primary-beam round: 'round' is not a known primary beam; the known names are airy, cosine-cubed,"
            " meerkat",
        ),
        (
            "--keep moments,spin",
            "--keep moments,spin: 'spin' is not a known estimator; the known names are mean, moments, bayesian,"
            " metacal",
        ),
        ("--keep moments --weight uniform", "another weighting cannot be combined with them"),
        ("--keep moments --extraction paper", "PaperExtraction keeps no statistics"),
        ("--memory-gb 0", "'--memory-gb': 0; a number above 0 is needed"),
        ("--threads -1", "--threads"),
        ("--size-prior catalogue", "has no column 'scale_length'"),
        ("--reference-frequency-mhz -3", "-3; a number above 0 is needed"),
        ("--column MODEL", "MODEL"),
    ],
)
def test_a_wrong_option_is_named_and_nothing_written(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, words: str, message: str
) -> None:
    before = sorted(tmp_path.iterdir())
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output, *words.split())
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (("absent.ms", "cat.ecsv", "shapes.fits"), "absent.ms"),
        (("cat.ecsv", "cat.ecsv", "shapes.fits"), "cat.ecsv"),
        ((".", "cat.ecsv", "shapes.fits"), "Measurement Set"),
        (("field.ms", "absent.fits", "shapes.fits"), "absent.fits: no such file"),
        (("field.ms", "field.ms", "shapes.fits"), "is a directory; a catalogue is needed"),
        (("field.ms", "cat.csv", "shapes.fits"), "column 'flux' has no unit"),
        (("field.ms", "cat.ecsv", "shapes.txt"), "the format of the table: .ecsv, .fits"),
        (("field.ms", "cat.ecsv", "nowhere/shapes.fits"), "does not exist"),
        (("field.ms", "cat.ecsv", "cat.ecsv"), "exists already; give --overwrite"),
    ],
)
def test_a_wrong_file_is_named_and_nothing_written(
    uvshear: Callable,
    tmp_path: Path,
    field: Path,
    catalogue: Path,
    files: tuple[str, str, str],
    message: str,
) -> None:
    assert field.exists()
    assert catalogue.exists()
    before = sorted(tmp_path.iterdir())
    measurement_set, sources, output = (tmp_path / name for name in files)
    outcome = uvshear("measure", measurement_set, "--catalogue", sources, "-o", output)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("columns", "value", "message"),
    [
        ("FLAG", True, "flagged"),
        ("WEIGHT_SPECTRUM WEIGHT SIGMA", 0.0, "weight"),
        ("WEIGHT_SPECTRUM WEIGHT SIGMA", -1.0, "weight"),
        ("DATA", np.nan, "not finite"),
    ],
)
def test_visibilities_of_which_none_is_usable_are_refused(
    uvshear: Callable,
    tmp_path: Path,
    field: Path,
    catalogue: Path,
    columns: str,
    value: object,
    message: str,
) -> None:
    with tables.table(str(field), readonly=False, ack=False) as main:
        for name in columns.split():
            main.putcol(name, np.full_like(main.getcol(name), value))
    before = sorted(tmp_path.iterdir())
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


def test_a_set_of_another_pointing_is_refused(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, layout: Path
) -> None:
    other = tmp_path / "other.ms"
    words = "--declination-deg -31 --hours 1 --integration-s 1800 --band-mhz 950 1190 --no-noise"
    common = ("--layout", layout, "--catalogue", catalogue)
    assert uvshear("simulate", *common, *words.split(), "-o", other).status == 0
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, other, "--catalogue", catalogue, "-o", output)
    assert outcome.status == 2
    assert "other.ms: its phase centre is 3.6e+03 arcsec from" in outcome.err
    assert not output.exists()


def test_a_set_given_twice_is_refused(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    outcome = uvshear(
        "measure", field, field, "--catalogue", catalogue, "-o", tmp_path / "shapes.fits"
    )
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1
    assert "is given twice" in outcome.err


def test_the_catalogue_is_not_overwritten_by_its_own_shapes(
    uvshear: Callable, field: Path, catalogue: Path
) -> None:
    before = catalogue.read_bytes()
    words = ("measure", field, "--catalogue", catalogue, "-o", catalogue, "--overwrite")
    outcome = uvshear(*words)
    assert outcome.status == 2
    assert "is an input too" in outcome.err
    assert catalogue.read_bytes() == before


def test_a_uv_range_beyond_all_baselines_is_refused(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output, "--uv-min", "1e9")
    assert outcome.status == 2
    assert "--uv-min 1e+09 (uv_range=): the longest baseline of the observation is" in outcome.err
    assert not output.exists()


@pytest.mark.real
@pytest.mark.parametrize(
    ("archive", "options"),
    [
        ("day2_TDEM0003_10s_norx_1src_1spw.ms.tar.gz", ()),
        ("tDish.MS.tgz", ("--ignore-flags",)),  # every visibility of it is flagged
        ("tOSKAR.in_MS.tgz", ()),
    ],
)
def test_real_sets_are_measured_at_the_phase_centre(
    uvshear: Callable, tmp_path: Path, archive: str, options: tuple[str, ...]
) -> None:
    """Raw data of no known source: a row with a flag in the table, and an error that names the flag."""
    path = real_set(tmp_path, archive)
    Table({"l": [0.0], "m": [0.0], "flux": [1000.0] * units.uJy}).write(tmp_path / "one.ecsv")
    output = tmp_path / "shapes.ecsv"
    words = ("measure", path, "--catalogue", tmp_path / "one.ecsv", "-o", output, *options)
    outcome = uvshear(*words)
    assert outcome.status == 2, outcome.err
    (flag,) = read_shapes(output)["flag"]
    assert f"no galaxy was measured: the most frequent flag is {flag}" in outcome.err


def test_likelihoods_are_kept_in_a_few_kilobytes(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    output = tmp_path / "shapes.fits"
    words = ("measure", field, "--catalogue", catalogue, "-o", output)
    outcome = uvshear(*words, "--keep", "likelihood,moments")
    assert outcome.status == 0, outcome.err
    kept = Table.read(statistics_path(output))
    assert np.all(kept["m1_var"] > 0)
    packed = [{name: np.asarray(row[name]) for name in PACKED} for row in kept]
    # Eight antennas may see galaxies that the population does not have.
    found = [kept_row for kept_row in packed if len(kept_row["lattice"])]
    assert found
    for kept_row in found:
        assert sum(array.nbytes for array in kept_row.values()) < 10_000
        likelihood = unpack(kept_row)
        assert likelihood.log_likelihood.max() == 0
        assert np.all(likelihood.flux > 0)


def test_metacalibrated_ellipticities_are_kept(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    output = tmp_path / "shapes.fits"
    words = ("measure", field, "--catalogue", catalogue, "-o", output)
    assert uvshear(*words, "--keep", "metacal").status == 0
    kept = Table.read(statistics_path(output))
    assert {"mc1", "mc2", "mc_r11", "mc_r12", "mc_r21", "mc_r22"} < set(kept.colnames)


def test_moments_are_kept_beside_the_shapes(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    output = tmp_path / "shapes.ecsv"
    words = ("measure", field, "--catalogue", catalogue, "-o", output, "--keep", "moments")
    outcome = uvshear(*words)
    assert outcome.status == 0, outcome.err
    kept = Table.read(statistics_path(output))
    assert kept["id"].tolist() == [1, 2, 3]
    assert kept["m1"].unit == units.Jy
    assert np.all(kept["m1_var"] > 0)
    shapes = read_shapes(output)
    made = read_statistics(statistics_path(output), output, shapes).meta
    for name in ("version", "command", "inputs", "options", "date"):
        assert made[name] == shapes.meta[name]
    assert made["estimators"] == "moments"
    assert json.loads(made["options"])["keep"] == "moments"
    assert uvshear(*words, "--extraction", "paper", "--overwrite").status == 2
    assert "is not a known estimator" in uvshear(*words[:-1], "spin", "--overwrite").err
    again = uvshear(*words)
    assert again.status == 2
    assert "exists already" in again.err


def test_a_catalogue_of_another_field_is_refused_before_the_work(
    uvshear: Callable, tmp_path: Path, field: Path
) -> None:
    elsewhere = tmp_path / "elsewhere.csv"
    elsewhere.write_text("id,ra,dec,flux\n1,40,-30,50\n2,41,-30,60\n")
    output = tmp_path / "shapes.fits"
    words = ("measure", field, "--catalogue", elsewhere, "--flux-unit", "uJy", "-o", output)
    outcome = uvshear(*words)
    assert outcome.status == 2
    assert "no source of the catalogue is in the field: the nearest is 34" in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert not output.exists()


def test_fluxes_out_of_proportion_are_the_likely_cause_where_nothing_is_measured(
    uvshear: Callable, tmp_path: Path, field: Path
) -> None:
    """The table is written all the same, so that its flags can be looked at."""
    janskys = tmp_path / "janskys.csv"
    janskys.write_text("id,l,m,flux\n1,0.0001,0,50\n2,0,-0.0002,90\n3,0.0002,0.0001,30\n")
    output = tmp_path / "shapes.fits"
    words = ("measure", field, "--catalogue", janskys, "--flux-unit", "Jy", "-o", output)
    outcome = uvshear(*words)
    assert outcome.status == 2, outcome.out
    assert "times those that the catalogue predicts; check the unit" in outcome.err
    assert sum("no galaxy was measured" in line for line in outcome.err.splitlines()) == 1
    assert "0 of 3 sources measured" in outcome.out
    assert len(read_shapes(output)) == 3
