"""The identity of a measurement."""

import numpy as np
import pytest
from astropy.io import fits
from astropy.table import Table

from uvshear.io.run_identity import LENGTH, new_run, run_in_file, run_of

MADE = {"version": "uvshear 1", "command": "uvshear measure", "date": "2026-01-01"}


def _shapes(**changes):
    columns = {"id": ["a", "b"], "e1": [0.1, np.nan], "flag": ["ok", "no_peak"]}
    return Table(columns | changes)


def test_the_same_measurement_has_the_same_identity():
    assert new_run(_shapes(), MADE) == new_run(_shapes(), dict(reversed(MADE.items())))
    assert len(new_run(_shapes(), MADE)) == LENGTH


@pytest.mark.parametrize(
    ("shapes", "made"),
    [
        (_shapes(e1=[0.1 + 1e-15, np.nan]), MADE),
        (_shapes(id=["a", "c"]), MADE),
        (_shapes(), MADE | {"command": "uvshear measure b.ms"}),
    ],
)
def test_any_difference_makes_another_identity(shapes, made):
    assert new_run(shapes, made) != new_run(_shapes(), MADE)


def test_masked_cells_have_an_identity():
    shapes = Table(_shapes(), masked=True)
    shapes["e1"].mask[1] = True
    assert len(new_run(shapes, MADE)) == LENGTH


@pytest.mark.parametrize("key", ["run", "RUN"])
def test_a_table_carries_it(key):
    assert run_of(Table(meta={key: "1234"})) == "1234"
    assert run_of(Table()) is None


def test_files_are_told_from_those_that_no_measurement_wrote(tmp_path):
    def written(name, meta):
        Table({"x": [1]}, meta=meta).write(tmp_path / name)
        return tmp_path / name

    assert run_in_file(written("ours.fits", {"RUN": "1234"})) == "1234"
    assert run_in_file(written("earlier.fits", {"COMMAND": "uvshear measure a.ms"})) == ""
    assert run_in_file(written("demo.fits", {"COMMAND": "uvshear demo here"})) == ""
    assert run_in_file(written("catalogue.fits", {"COMMAND": "uvshear catalogue"})) is None
    assert run_in_file(written("any.fits", {})) is None
    (tmp_path / "text.fits").write_text("text")
    assert run_in_file(tmp_path / "text.fits") is None
    fits.PrimaryHDU().writeto(tmp_path / "image.fits")
    assert run_in_file(tmp_path / "image.fits") is None
    assert run_in_file(tmp_path / "nothing.fits") is None
