from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.arrays import EIGHT_ANTENNAS
from uvshear.cli.application import run


class Outcome(NamedTuple):
    status: int
    out: str
    err: str


@pytest.fixture
def uvshear(capfd: pytest.CaptureFixture[str]) -> Callable[..., Outcome]:
    """Run a command line in this process; what it says is taken from the file descriptors."""

    def invoke(*words: str | Path) -> Outcome:
        capfd.readouterr()
        status = run([str(word) for word in words])
        return Outcome(status, *capfd.readouterr())

    return invoke


@pytest.fixture
def catalogue(tmp_path: Path) -> Path:
    """Three sources at (l, m)."""
    path = tmp_path / "cat.csv"
    path.write_text("id,l,m,flux\n1,0.0001,0,50\n2,0,-0.0002,90\n3,0.0002,0.0001,30\n")
    table = path.with_suffix(".ecsv")
    table.write_text(
        "# %ECSV 1.0\n# ---\n# datatype:\n# - {name: id, datatype: int64}\n"
        "# - {name: l, datatype: float64}\n# - {name: m, datatype: float64}\n"
        "# - {name: flux, unit: uJy, datatype: float64}\n# schema: astropy-2.0\n"
        "id l m flux\n1 0.0001 0 50\n2 0 -0.0002 90\n3 0.0002 0.0001 30\n"
    )
    return table


@pytest.fixture
def layout(tmp_path: Path) -> Path:
    """Eight antennas over 30 km, which resolve galaxies of one arcsecond."""
    path = tmp_path / "array.txt"
    path.write_text(EIGHT_ANTENNAS)
    return path


@pytest.fixture
def field(tmp_path: Path, uvshear: Callable[..., Outcome], catalogue: Path, layout: Path) -> Path:
    """Return a small Measurement Set of the three sources."""
    path = tmp_path / "field.ms"
    words = "--declination-deg -30 --hours 1 --integration-s 600 --band-mhz 950 1190 --snr-at 10 50"
    outcome = uvshear(
        "simulate", "--layout", layout, "--catalogue", catalogue, *words.split(), "-o", path
    )
    assert outcome.status == 0, outcome.err
    return path
