"""The times that a Measurement Set is read by ``uvshear measure``, and the warnings before it works."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from casacore import tables

from tests.io.measurement_sets import change, written
from uvshear.extraction import ConvergedExtraction
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.io.shapes import extraction_record, read_shapes


class Reads:
    """Counts passes over a set, and the rows of its data that casacore hands out."""

    def __init__(self) -> None:
        self.passes = 0
        self.rows: Counter[str] = Counter()


@pytest.fixture
def reads(monkeypatch: pytest.MonkeyPatch) -> Reads:
    counted = Reads()
    chunks, getcolnp, getcol = MeasurementSet.chunks, tables.table.getcolnp, tables.table.getcol

    def counting_chunks(self: MeasurementSet):
        counted.passes += 1
        return chunks(self)

    def counting_getcolnp(self, name, array, start=0, rows=-1, step=1):
        counted.rows[name] += len(array)
        return getcolnp(self, name, array, start, rows, step)

    def counting_getcol(self, name, start=0, rows=-1, step=1):
        found = getcol(self, name, start, rows, step)
        counted.rows[name] += len(found)
        return found

    monkeypatch.setattr(MeasurementSet, "chunks", counting_chunks)
    monkeypatch.setattr(tables.table, "getcolnp", counting_getcolnp)
    monkeypatch.setattr(tables.table, "getcol", counting_getcol)
    return counted


@pytest.mark.parametrize("more", ["", "--keep moments", "--uv-min 10"])
def test_a_small_set_is_read_once(
    uvshear: Callable, reads: Reads, tmp_path: Path, field: Path, catalogue: Path, more: str
) -> None:
    with tables.table(str(field), ack=False) as main:
        rows = main.nrows()
    reads.rows.clear()
    reads.passes = 0
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output, *more.split())
    assert outcome.status == 0, outcome.err
    cycles = extraction_record(read_shapes(output))["major_cycles"]
    assert isinstance(cycles, int)
    assert 2 <= cycles < 20
    assert reads.passes == 1
    # The visibilities themselves, whichever way they leave casacore, and the first cell.
    assert rows <= reads.rows["DATA"] <= rows + 2


def test_a_residual_image_reads_once_more(
    uvshear: Callable, reads: Reads, tmp_path: Path, field: Path, catalogue: Path
) -> None:
    words = ("measure", field, "--catalogue", catalogue, "-o", tmp_path / "shapes.fits")
    assert uvshear(*words).status == 0
    before = reads.passes
    reads.passes = 0
    image = ("--residual-image", tmp_path / "left.fits")
    assert uvshear(*words, *image, "--overwrite").status == 0
    assert reads.passes == before + 1


def test_notes_about_the_data_come_before_the_first_fit(
    uvshear: Callable,
    tmp_path: Path,
    catalogue: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    field = written(tmp_path)
    change(field, "DATA", np.nan, rows=slice(0, 2))
    told: list[str] = []

    def begin(*_args: object, **_more: object) -> None:
        told.append(capfd.readouterr().err)
        raise KeyboardInterrupt

    monkeypatch.setattr(ConvergedExtraction, "extract", begin)
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output)
    assert outcome.status == 130
    (note,) = told[0].splitlines()
    assert note.startswith(f"uvshear: note: {field}: ")
    assert "are NaN or infinite" in note
    assert "note" not in outcome.err
    assert not output.exists()


def test_the_noise_is_told_once_when_the_sources_are_fitted(
    uvshear: Callable, tmp_path: Path, catalogue: Path
) -> None:
    field = written(tmp_path)
    change(field, "WEIGHT_SPECTRUM", 1e-3)
    output = tmp_path / "shapes.fits"
    outcome = uvshear("measure", field, "--catalogue", catalogue, "-o", output)
    (note,) = (line for line in outcome.err.splitlines() if "the weights" in line)
    assert note.startswith(f"uvshear: note: {field}: the noise is ")
    assert "times what the weights claim, judging by" in note
    outcome = uvshear(
        "measure", field, "--catalogue", catalogue, "-o", output, "--noise", "data", "--overwrite"
    )
    assert "the weights" not in outcome.err
