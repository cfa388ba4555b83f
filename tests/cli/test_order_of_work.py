"""What can be known to be wrong before the work is refused before the work."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.arrays import EIGHT_ANTENNAS
from uvshear.bias import isolated
from uvshear.cli.application import run
from uvshear.io.measurement_set.observation import MeasurementSet
from uvshear.pipeline import shear
from uvshear.simulation.observation import SimulatedObservation


class WorkHasBegunError(Exception):
    """Something was computed or read that takes long with large data."""


MEASURE = "measure {0}/field.ms --catalogue {0}/cat.ecsv"
SIMULATE = (
    "simulate --layout {0}/array.txt --catalogue {0}/cat.ecsv --declination-deg -30 --hours 1 --integration-s 600"
    " --band-mhz 950 1190 --snr-at 10 50"
)
BIAS = (
    "bias --estimator mean --layout {0}/array.txt --galaxies 200 --hours 1 --integration-s 600 --snr-at 10 50"
    " --shear 0.05 --seed 1 --threads 1"
)
SHEAR = "shear {0}/known.fits"
PSF = "psf {0}/field.ms"

CATALOGUE = """\
# %ECSV 1.0
# ---
# datatype:
# - {name: id, datatype: int64}
# - {name: l, datatype: float64}
# - {name: m, datatype: float64}
# - {name: flux, unit: uJy, datatype: float64}
# schema: astropy-2.0
id l m flux
1 0.0001 0 50
2 0 -0.0002 90
3 0.0002 0.0001 30
"""


@pytest.fixture(scope="module")
def _made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A directory with a set, catalogues, shapes with their statistics, and a file and a directory in the way."""
    made = tmp_path_factory.mktemp("made")
    (made / "array.txt").write_text(EIGHT_ANTENNAS)
    (made / "cat.ecsv").write_text(CATALOGUE)
    for words in (f"{SIMULATE} -o {{0}}/field.ms", f"{MEASURE} --keep moments -o {{0}}/known.fits"):
        assert run(words.format(made).split()) == 0
    umlaut = CATALOGUE.replace("int64", "string").replace("\n1 ", "\nGr\u00fcn ")
    (made / "umlaut.ecsv").write_text(umlaut)
    (made / "twice.ecsv").write_text(CATALOGUE.replace("\n2 ", "\n1 "))
    (made / "far.ecsv").write_text(CATALOGUE.replace("0.0002", "1.5"))
    (made / "there.fits").write_text("mine")
    (made / "there.json").write_text("mine")
    for name in ("there.ms", "there.png"):
        (made / name).mkdir()
        (made / name / "mine").write_text("mine")
    return made


@pytest.fixture
def files(tmp_path: Path, _made: Path) -> Path:
    """A copy of these."""
    return Path(shutil.copytree(_made, tmp_path / "files"))


@pytest.fixture
def nothing_works(files: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert files.is_dir()

    def begin(*_: object, **__: object) -> None:
        raise WorkHasBegunError

    monkeypatch.setattr(MeasurementSet, "unchecked_chunks", begin)
    monkeypatch.setattr(SimulatedObservation, "planned", begin)
    monkeypatch.setattr(isolated, "_run", begin)
    monkeypatch.setattr(shear, "estimate_sample_shear", begin)


@pytest.mark.usefixtures("nothing_works")
@pytest.mark.parametrize(
    "words",
    [
        f"{MEASURE} -o {{0}}/o.fits",
        f"{SIMULATE} -o {{0}}/o.ms",
        f"{BIAS} -o {{0}}/o.json",
        f"{SHEAR} -o {{0}}/o.json",
        f"{SHEAR} --estimator moments",
        PSF,
    ],
)
def test_without_a_fault_the_work_begins(files: Path, uvshear: Callable, words: str) -> None:
    with pytest.raises(WorkHasBegunError):
        uvshear(*words.format(files).split())


@pytest.mark.usefixtures("nothing_works")
@pytest.mark.parametrize(
    "words",
    [
        # outputs that are there, have no place, have no format, or are written twice
        f"{MEASURE} -o {{0}}/there.fits",
        f"{MEASURE} -o {{0}}/known.fits",
        f"{MEASURE} -o {{0}}/absent/o.fits",
        f"{MEASURE} -o {{0}}/o.dat",
        f"{MEASURE} -o {{0}}",
        f"{MEASURE} -o {{0}}/o.fits --residual-image {{0}}/there.fits",
        f"{MEASURE} -o {{0}}/o.fits --residual-image {{0}}/absent/r.fits",
        f"{MEASURE} -o {{0}}/o.fits --residual-image {{0}}/o.fits",
        f"{MEASURE} -o {{0}}/o.fits --residual-image {{0}}/r.txt",
        f"{SIMULATE} -o {{0}}/there.ms",
        f"{SIMULATE} -o {{0}}/absent/o.ms",
        f"{SIMULATE} -o {{0}}/there.ms --overwrite",
        f"{BIAS} -o {{0}}/there.json",
        f"{BIAS} -o {{0}}/absent/o.json",
        f"{BIAS} -o {{0}}",
        f"{SHEAR} -o {{0}}/there.json",
        f"{SHEAR} -o {{0}}/absent/o.json",
        f"{PSF} -o {{0}}/there.png",
        f"{PSF} -o {{0}}/absent/o.png",
        f"{PSF} -o {{0}}/o.docx",
        f"{PSF} -o {{0}}/o.png --uv-output {{0}}/o.png",
        # identifiers that no output could hold, or that name two sources
        f"{MEASURE} --catalogue {{0}}/umlaut.ecsv -o {{0}}/o.fits",
        f"{MEASURE} --catalogue {{0}}/twice.ecsv -o {{0}}/o.fits",
        # columns, units and positions
        f"{MEASURE} --column MODEL_DATA -o {{0}}/o.fits",
        f"{MEASURE} --column-map flux=S -o {{0}}/o.fits",
        f"{MEASURE} --catalogue {{0}}/far.ecsv -o {{0}}/o.fits",
        f"{MEASURE} --size-prior catalogue -o {{0}}/o.fits",
        f"{MEASURE} --subtract DATA -o {{0}}/o.fits",
        f"{MEASURE} --scans 7 -o {{0}}/o.fits",
        f"{MEASURE} --field other -o {{0}}/o.fits",
        # names and numbers of options
        f"{MEASURE} --keep moment -o {{0}}/o.fits",
        f"{MEASURE} --keep moments --extraction paper -o {{0}}/o.fits",
        f"{MEASURE} --profile point -o {{0}}/o.fits",
        f"{MEASURE} --primary-beam no.such:beam -o {{0}}/o.fits",
        f"{MEASURE} --extraction no -o {{0}}/o.fits",
        f"{MEASURE} --weight briggs -o {{0}}/o.fits",
        f"{MEASURE} --uv-min 5 --uv-max 4 -o {{0}}/o.fits",
        f"{MEASURE} --memory-gb 0 -o {{0}}/o.fits",
        f"{SIMULATE} --primary-beam no -o {{0}}/o.ms",
        f"{SIMULATE} --shear 2 0 -o {{0}}/o.ms",
        f"{SIMULATE} --channels 0 -o {{0}}/o.ms",
        f"{BIAS} --estimator no -o {{0}}/o.json",
        f"{BIAS} --wraps moments -o {{0}}/o.json",
        f"{BIAS} --estimator bayesian --prior {{0}}/absent.json -o {{0}}/o.json",
        # statistics that were not kept, and records that are none
        f"{SHEAR} --estimator bayesian",
        f"{SHEAR} --estimator moments --prior fitted",
        f"{SHEAR} --calibration {{0}}/there.json",
        f"{SHEAR} --estimator moments --calibration {{0}}/absent.json",
    ],
)
def test_a_fault_is_refused_before_the_work(files: Path, uvshear: Callable, words: str) -> None:
    before = sorted(path for path in files.rglob("*") if "field.ms" not in path.parts)
    outcome = uvshear(*words.format(files).split())
    assert outcome.status == 2
    assert len(outcome.err.splitlines()) == 1, outcome.err
    assert outcome.err.startswith("uvshear: error: ")
    assert sorted(path for path in files.rglob("*") if "field.ms" not in path.parts) == before
