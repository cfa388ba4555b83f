"""The clean files of all situations, and their shapes."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from astropy.table import Table

from tests.arrays import EIGHT_ANTENNAS
from tests.situations.situation import Files
from uvshear.cli.application import run


@pytest.fixture(scope="session")
def clean(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Table]:
    """Return the directory of the clean files, and the shapes of the clean measurement."""
    directory = tmp_path_factory.mktemp("clean")
    (directory / "array.txt").write_text(EIGHT_ANTENNAS)
    for words in (
        "catalogue --field-arcmin 3 --count 3 --flux-ujy 50 100 --seed 5 --ra-deg 60 --declination-deg -30"
        " -o {}/cat.ecsv",
        "simulate --layout {}/array.txt --catalogue {}/cat.ecsv --hours 4 --integration-s 600 --band-mhz 950 1190"
        " --channels 4 --snr-at 50 50 --seed 2 --threads 1 -o {}/field.ms",
        "measure {}/field.ms --catalogue {}/cat.ecsv --keep moments --threads 1 -o {}/clean.fits",
    ):
        assert run(words.replace("{}", str(directory)).split()) == 0
    return directory, Table.read(directory / "clean.fits")


@pytest.fixture
def files(tmp_path: Path, clean: tuple[Path, Table]) -> Iterator[Files]:
    """Return copies of the clean files."""
    shutil.copytree(clean[0], tmp_path / "here", symlinks=True)
    yield Files(tmp_path / "here")
    for path in (tmp_path / "here").rglob("*"):
        if path.is_dir() and not path.is_symlink():
            path.chmod(0o755)


@pytest.fixture
def uvshear(capfd: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    """Run a command, and return its status and what it said on standard error."""

    def invoke(words: list[str]) -> tuple[int, str]:
        capfd.readouterr()
        status = run(words)
        return status, capfd.readouterr().err

    return invoke
