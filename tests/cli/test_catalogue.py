from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

from uvshear.constants import ARCMIN
from uvshear.io.catalogue import read_catalogue


def test_a_density_gives_its_number_within_the_field(uvshear: Callable, tmp_path: Path) -> None:
    path = tmp_path / "cat.fits"
    words = "--field-arcmin 6 --density 2.8 --flux-ujy 20 100 --seed 3"
    assert uvshear("catalogue", *words.split(), "-o", path).status == 0
    catalogue = read_catalogue(path)
    assert len(catalogue) == 101
    assert catalogue.l is not None
    assert np.all(np.abs(catalogue.l) <= 3 * ARCMIN)
    assert np.all((catalogue.flux >= 20e-6) & (catalogue.flux <= 100e-6))


def test_rings_share_their_size_and_cancel(uvshear: Callable, tmp_path: Path) -> None:
    path = tmp_path / "cat.fits"
    words = "--field-arcmin 6 --count 20 --ring 10 --disc"
    assert uvshear("catalogue", *words.split(), "-o", path).status == 0
    catalogue = read_catalogue(path)
    assert catalogue.scale_length is not None
    assert catalogue.ellipticity is not None
    assert len(np.unique(catalogue.scale_length)) == 2
    assert abs(catalogue.ellipticity[:10].mean()) < 1e-12


def test_the_same_seed_gives_the_same_file(uvshear: Callable, tmp_path: Path) -> None:
    for name, seed in (("a.ecsv", 1), ("b.ecsv", 1), ("c.ecsv", 2)):
        words = f"--field-arcmin 6 --count 9 --seed {seed} -o {tmp_path / name}"
        assert uvshear("catalogue", *words.split()).status == 0
    # The date in the metadata may be a second later.
    a, b, c = (Table.read(tmp_path / f"{name}.ecsv") for name in "abc")
    assert all((a[name] == b[name]).all() for name in a.colnames)
    assert not (a["flux"] == c["flux"]).any()


def test_a_centre_gives_equatorial_positions(uvshear: Callable, tmp_path: Path) -> None:
    path = tmp_path / "cat.fits"
    words = "--field-arcmin 6 --count 9 --ra-deg 359.99 --declination-deg 80"
    assert uvshear("catalogue", *words.split(), "-o", path).status == 0
    catalogue = read_catalogue(path)
    assert catalogue.l is None
    assert catalogue.field_centre is not None
    l, m, _ = catalogue.directions(catalogue.field_centre)
    assert np.all(np.abs(l) <= 3 * ARCMIN)
    assert np.all(np.abs(m) <= 3 * ARCMIN)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--field-arcmin -6 --density 2.8", "'--field-arcmin': -6; a number above 0 is needed"),
        ("--field-arcmin nan --density 2.8", "'--field-arcmin': nan; a number above 0 is needed"),
        ("--field-arcmin inf --density 2.8", "'--field-arcmin': inf; a number above 0 is needed"),
        ("--field-arcmin 9000 --density 2.8", "--field-arcmin 9000: a field below 3437"),
        ("--field-arcmin 6 --density 0", "'--density': 0; a number above 0 is needed"),
        ("--field-arcmin 6 --density 1e-4", "less than half of a ring of 1"),
        ("--field-arcmin 6 --count 0", "'--count': 0; a number above 0 is needed"),
        ("--field-arcmin 6", "--density or --count: give one of the two"),
        ("--field-arcmin 6 --count 5 --density 1", "--density or --count: give one of the two"),
        ("--field-arcmin 6 --count 15 --ring 10", "--count 15: a multiple of the ring size 10"),
        ("--field-arcmin 6 --count 10 --ring -1", "'--ring': -1; a number above 0 is needed"),
        ("--field-arcmin 6 --count 5 --flux-ujy 200 10", "200 10 is not a range; 0 < LO < HI"),
        ("--field-arcmin 6 --count 5 --flux-ujy -1 10", "-1 10 is not a range; 0 < LO < HI"),
        ("--field-arcmin 6 --count 5 --seed -1", "--seed"),
        ("--field-arcmin 6 --count 5 --declination-deg 91", "91; a declination between -90 and 90"),
        ("--field-arcmin 6 --count 5 --ra-deg 10", "--ra-deg: --declination-deg is needed as well"),
    ],
)
def test_a_wrong_number_is_named_and_nothing_written(
    uvshear: Callable, tmp_path: Path, words: str, message: str
) -> None:
    outcome = uvshear("catalogue", *words.split(), "-o", tmp_path / "cat.fits")
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nowhere/cat.fits", "does not exist"),
        ("cat.docx", "the format of the table: .ecsv, .fits"),
        ("cat", "the format of the table: .ecsv, .fits"),
        ("there.fits", "exists already; give --overwrite"),
    ],
)
def test_a_wrong_output_is_named_before_computing(
    uvshear: Callable, tmp_path: Path, name: str, message: str
) -> None:
    (tmp_path / "there.fits").write_text("kept")
    outcome = uvshear("catalogue", "--field-arcmin", "6", "--count", "5", "-o", tmp_path / name)
    assert outcome.status == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["there.fits"]
    assert (tmp_path / "there.fits").read_text() == "kept"
