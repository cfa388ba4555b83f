import json

import numpy as np
import pytest

from uvshear.constants import ARCSEC
from uvshear.errors import InputError
from uvshear.execution import SERIAL, Resources, Threads
from uvshear.imaging import ImageGrid
from uvshear.reproduce import run
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.psf_images import PsfImages
from uvshear.reproduce.run import reproduce_paper


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Only one small target, of which the calls are counted."""
    calls = []

    def targets_at(scale, names, seed):
        grid = ImageGrid(256, 0.15 * ARCSEC)
        integration = 7200.0 if scale == "quick" else 3600.0
        plateau = (5 * ARCSEC, 15 * ARCSEC)
        pointing = PaperPointing(integration=integration)
        return (PsfImages(seed, pointing, grid, plateau=plateau),)

    measure = PsfImages.measure

    def counted(self, task):
        calls.append(task)
        return measure(self, task)

    monkeypatch.setattr(run, "targets_at", targets_at)
    monkeypatch.setattr(PsfImages, "measure", counted)
    return calls


def _run(place, **options):
    return reproduce_paper(place, **({"resources": Resources(SERIAL)} | options))


def test_a_page_a_picture_and_the_numbers_are_written(tmp_path, small):
    seen = []
    page = _run(tmp_path / "out", progress=lambda done, total: seen.append((done, total)))
    assert page == tmp_path / "out" / "index.md"
    assert "psf-images.png" in page.read_text()
    assert (tmp_path / "out" / "psf-images.png").read_bytes().startswith(b"\x89PNG")
    record = json.loads((tmp_path / "out" / "psf-images.json").read_text())
    assert record["scale"] == "quick"
    assert record["version"]
    assert seen[-1][0] == seen[-1][1]
    assert len(small) == 2


def test_a_second_run_uses_the_parts_and_writes_the_same_page(tmp_path, small):
    first = _run(tmp_path).read_text()
    assert _run(tmp_path).read_text() == first
    assert len(small) == 2
    (tmp_path / "parts" / "psf-images" / "uniform.npz").unlink()
    _run(tmp_path)
    assert len(small) == 3
    _run(tmp_path, overwrite=True)
    assert len(small) == 5


def test_the_progress_is_that_of_the_parts_that_are_missing(tmp_path, small):
    seen = {"first": [], "second": []}
    _run(tmp_path, progress=lambda *work: seen["first"].append(work))
    (tmp_path / "parts" / "psf-images" / "uniform.npz").unlink()
    _run(tmp_path, progress=lambda *work: seen["second"].append(work))
    whole, half = (seen[run][-1][1] for run in seen)
    assert len(small) == 3
    assert half == pytest.approx(whole / 2)
    assert len(seen["second"]) < len(seen["first"])


def test_parts_of_other_options_are_refused(tmp_path):
    _run(tmp_path)
    with pytest.raises(InputError, match="scale was quick and is paper now; give another") as told:
        _run(tmp_path, scale="paper")
    assert "\n" not in str(told.value)
    with pytest.raises(InputError, match="seed was 1 and is 2 now"):
        _run(tmp_path, seed=2)


def test_parts_of_another_version_are_refused(tmp_path, monkeypatch):
    _run(tmp_path)
    monkeypatch.setattr(run, "__version__", "9.9")
    with pytest.raises(InputError, match="these parts belong to another computation: version was"):
        _run(tmp_path)


def test_a_damaged_part_is_told_in_one_line(tmp_path):
    _run(tmp_path)
    part = tmp_path / "parts" / "psf-images" / "natural.npz"
    part.write_bytes(part.read_bytes()[:1000])
    with pytest.raises(InputError, match="this part of the computation is damaged"):
        _run(tmp_path)


@pytest.mark.parametrize("what", ["a file", "a page"])
def test_what_is_there_is_not_replaced(tmp_path, what):
    place = tmp_path / "out"
    if what == "a file":
        place.write_text("mine")
    else:
        place.mkdir()
        (place / "index.md").write_text("mine")
    with pytest.raises(InputError, match=r"is a file; a directory|exists already, and is not"):
        _run(place)
    assert "mine" in (place if what == "a file" else place / "index.md").read_text()


def test_any_executor_gives_the_same_parts(tmp_path):
    _run(tmp_path / "one")
    _run(tmp_path / "two", resources=Resources(Threads(2)))
    for name in ("natural", "uniform"):
        images = []
        for place in ("one", "two"):
            with np.load(tmp_path / place / "parts" / "psf-images" / f"{name}.npz") as part:
                images.append(part["image"])
        np.testing.assert_array_equal(*images)
