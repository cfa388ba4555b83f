"""A disk that fills: one line, status 2, nothing half-written, and the earlier file kept.

A limit of the size of files stands for the disk, since every user can set one.
"""

from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table

from tests.cli.processes import shell

NO_CHECKPOINT = "uvshear: note: s.checkpoint: the state of the measurement could not be stored (File too large);"
SIMULATION = "simulate --layout meerkat --declination-deg -30 --hours 0.2 --integration-s 60 --band-mhz 950 1190"


def _refused(words: str, directory: Path, limit: int) -> str:
    """Run a command in a shell with a limit of the size of files [kB], and return the line of its error."""
    before = {path.name: path.read_bytes() for path in directory.iterdir() if path.is_file()}
    # Python would write cut bytecode of its modules, and fail on them later.
    limited = f"ulimit -f {limit}; uvshear {words} >/dev/null"
    done = shell(limited, directory, PYTHONDONTWRITEBYTECODE="1")
    assert done.returncode == 2, done.stderr
    *notes, line = done.stderr.splitlines()
    assert all(note.startswith(NO_CHECKPOINT) for note in notes)
    after = {path.name: path.read_bytes() for path in directory.iterdir() if path.is_file()}
    assert after == before
    return line


@pytest.mark.parametrize("name", ["cat.fits", "cat.ecsv", "cat.vot"])
def test_a_catalogue_is_written_whole_or_not(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("an earlier one")
    words = f"catalogue --field-arcmin 3 --count 300 --overwrite -o {name}"
    assert _refused(words, tmp_path, 4).startswith(f"uvshear: error: {name}: cannot be written")


@pytest.mark.parametrize("name", ["map.png", "map.pdf", "map.svg"])
def test_a_picture_is_drawn_whole_or_not(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("an earlier one")
    words = f"layouts vla-a --overwrite -o {name}"
    assert "File too large" in _refused(words, tmp_path, 4)


@pytest.mark.parametrize("limit", [0, 10, 40, 200])
def test_a_measurement_set_is_written_whole_or_not(
    tmp_path: Path, catalogue: Path, limit: int
) -> None:
    words = f"{SIMULATION} --snr-at 10 10 --threads 1 --catalogue {catalogue} -o field.ms"
    line = _refused(words, tmp_path, limit)
    assert [path.name for path in tmp_path.iterdir() if path.is_dir()] == []
    assert line.startswith("uvshear: error: field.ms: cannot be written")


@pytest.mark.parametrize("limit", [4, 22])
def test_shapes_are_written_with_their_statistics_or_not(
    tmp_path: Path, field: Path, catalogue: Path, limit: int
) -> None:
    directory = tmp_path / "results"
    directory.mkdir()
    words = f"measure {field} --catalogue {catalogue} --keep moments,bayesian --threads 1 -o s.fits"
    line = _refused(words, directory, limit)
    assert "cannot be written" in line
    assert ("the state of the measurement is in s.checkpoint" in line) == (limit > 4)
    # What the limit left of the state is enough to write the shapes, once there is room.
    stored = {path.name for path in directory.rglob("*.state")}
    assert stored == ({"extraction.extracted.state"} if limit > 4 else set())
    assert [path.name for path in directory.iterdir()] == (["s.checkpoint"] if limit > 4 else [])
    done = shell(f"uvshear {words} --resume", directory)
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in directory.iterdir()) == [
        "s.fits",
        "s.sky.fits",
        "s.stats.fits",
    ]


def test_a_shear_is_written_whole_or_not(tmp_path: Path) -> None:
    rows = np.arange(1, 41)
    columns = {name: 0.01 * np.cos(rows + k) for k, name in enumerate(("l", "m", "e1", "e2"))}
    flags = {"flag": ["ok"] * 40}
    table = Table(
        {"id": rows} | columns | dict.fromkeys(("e_sigma", "weight", "snr"), rows) | flags
    )
    table.meta |= {"ra0_deg": 60.0, "dec0_deg": -30.0}
    table.write(tmp_path / "s.ecsv")
    (tmp_path / "s.json").write_text("{}")
    line = _refused("shear s.ecsv --overwrite -o s.json", tmp_path, 0)
    assert "s.json: cannot be written" in line
