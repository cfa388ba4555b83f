"""Catalogues of other people, as commands read them."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from astropy.io import fits
from astropy.table import Table

from tests.cli.conftest import Outcome


@pytest.fixture
def shapes(uvshear: Callable[..., Outcome], tmp_path: Path, field: Path, catalogue: Path) -> Table:
    """Shapes with the field's own catalogue."""
    output = tmp_path / "own.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output)
    assert outcome.status == 0, outcome.err
    return Table.read(output)


def _same(shapes: Table, path: Path) -> bool:
    return all(np.array_equal(shapes[name], Table.read(path)[name]) for name in ("e1", "e2", "snr"))


def test_columns_of_other_names_are_mapped(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, shapes: Table
) -> None:
    table = Table.read(catalogue)
    table.rename_columns(["id", "l", "m", "flux"], ["Name", "X", "Y", "S 1.4"])
    table.write(tmp_path / "list.txt", format="ascii.csv", delimiter=";")
    output = tmp_path / "shapes.fits"
    words = ("measure", field, "--catalogue", tmp_path / "list.txt", "-o", output)
    outcome = uvshear(*words, "--column-map", "id=Name,l=X,m=Y,flux=S 1.4", "--flux-unit", "uJy")
    assert (outcome.status, outcome.err) == (0, "")
    assert _same(shapes, output)
    outcome = uvshear(*words, "--column-map", "l=Z", "--overwrite")
    assert outcome.status == 2
    assert "has no column 'Z'" in outcome.err


def test_a_list_without_identifiers_is_noted(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, shapes: Table
) -> None:
    table = Table.read(catalogue)
    table.remove_column("id")
    table.write(tmp_path / "list.fits")
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", tmp_path / "list.fits", "-o", output)
    assert outcome.status == 0
    assert "note: " in outcome.err
    assert "has no column of identifiers; its sources are numbered by row, from 1" in outcome.err
    assert Table.read(output)["id"].tolist() == [1, 2, 3]
    assert _same(shapes, output)


def test_one_of_several_tables_is_chosen(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, shapes: Table
) -> None:
    table = Table.read(catalogue)
    path = tmp_path / "two.fits"
    fits.HDUList(
        [fits.PrimaryHDU(), fits.table_to_hdu(table[:1]), fits.table_to_hdu(table)]
    ).writeto(path)
    output = tmp_path / "shapes.fits"
    words = ("measure", field, "-o", output)
    outcome = uvshear(*words, "--catalogue", path)
    assert outcome.status == 2
    assert "(1 of 1 rows, 2 of 3 rows); choose one, as in two.fits[2]" in outcome.err
    outcome = uvshear(*words, "--catalogue", f"{path}[2]")
    assert (outcome.status, outcome.err) == (0, "")
    assert _same(shapes, output)
    before = path.read_bytes()
    outcome = uvshear("measure", field, "--catalogue", f"{path}[2]", "-o", path, "--overwrite")
    assert outcome.status == 2
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("J\u22121", r"identifier 'J\u22121' in row 2 has the character U+2212"),
        ("#1", "begins with '#'"),
    ],
)
def test_identifiers_that_no_output_can_hold_are_refused_before_the_work(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path, name: str, message: str
) -> None:
    table = Table.read(catalogue)
    table["id"] = ["a", name, "c"]
    table = table["l", "m", "flux", "id"]  # a line that begins with # would be a comment
    path = tmp_path / "list.csv"
    table.write(path, format="ascii.csv")
    output = tmp_path / "shapes.ecsv"
    outcome = uvshear("measure", field, "--catalogue", path, "-o", output, "--flux-unit", "uJy")
    assert outcome.status == 2
    assert len(outcome.err.splitlines()) == 1
    assert message in outcome.err
    assert not list(tmp_path.glob("*shapes*"))


def test_identifiers_are_those_of_the_list_in_every_format(
    uvshear: Callable, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    table = Table.read(catalogue)
    table["id"] = ["007", "7", "a b"]
    path = tmp_path / "list.csv"
    table.write(path, format="ascii.csv")
    for suffix in ("fits", "ecsv", "vot"):
        output = tmp_path / f"{suffix}.{suffix}"
        words = ("--flux-unit", "uJy", "-o", output)
        outcome = uvshear("measure", field, "--catalogue", path, *words)
        assert (outcome.status, outcome.err) == (0, "")
        assert Table.read(output)["id"].astype(str).tolist() == ["007", "7", "a b"]


def test_simulate_reads_them_too(
    uvshear: Callable, tmp_path: Path, catalogue: Path, layout: Path
) -> None:
    table = Table.read(catalogue)
    table.rename_columns(["flux"], ["S"])
    path = tmp_path / "list.fits"
    table.write(path)
    words = "--declination-deg -30 --hours 1 --integration-s 600 --band-mhz 950 1190 --no-noise"
    common = ("simulate", "--layout", layout, "--catalogue", path, *words.split())
    outcome = uvshear(*common, "-o", tmp_path / "a.ms")
    assert outcome.status == 2
    assert re.search(r"has no column 'flux' .*--column-map flux=NAME", outcome.err)
    outcome = uvshear(*common, "--column-map", "flux=S", "-o", tmp_path / "a.ms")
    assert outcome.status == 0, outcome.err
