"""A command that is killed leaves no broken or mixed file, and the next run is as if nothing had been."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.arrays import EIGHT_ANTENNAS
from tests.cli.processes import PACKAGE, environment
from tests.kills.commands import COMMANDS

ROOT = Path(__file__).parents[2]


@pytest.fixture
def layout(tmp_path: Path) -> Path:
    """Write the array of all observations."""
    path = tmp_path / "array.txt"
    path.write_text(EIGHT_ANTENNAS)
    return path


def _killed(directory: Path, name: str, kills: int, seed: int) -> tuple[int, int]:
    """Return the number of kills that came before the end, and the number of events of files."""
    ended = subprocess.run(
        [sys.executable, "-m", "tests.kills.server", name, str(kills), str(seed)],
        capture_output=True,
        check=False,
        text=True,
        cwd=directory,
        env=environment(PYTHONPATH=f"{PACKAGE}:{ROOT}"),
    )
    assert ended.returncode == 0, ended.stderr[-2000:]
    killed, events = ended.stdout.split()
    return int(killed), int(events)


@pytest.mark.parametrize("name", ["catalogue", "simulate", "measure"])
def test_a_few_kills(tmp_path: Path, layout: Path, name: str) -> None:
    assert layout.name == "array.txt"
    killed, events = _killed(tmp_path, name, 3, seed=1)
    assert killed == 3
    assert events > 50


@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_a_hundred_kills(tmp_path: Path, layout: Path, name: str) -> None:
    assert layout.name == "array.txt"
    killed, _ = _killed(tmp_path, name, 100, seed=2)
    assert killed == 100


@pytest.mark.long
@pytest.mark.parametrize("seed", [3, 4])
def test_the_demo_goes_on_from_what_a_killed_one_has_left(tmp_path: Path, seed: int) -> None:
    killed, _ = _killed(tmp_path, "demo", 50, seed)
    assert killed == 50
