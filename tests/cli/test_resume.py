"""``measure --resume``: a run that was ended is continued, and ends with the same bits."""

import os
import shutil
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from astropy.table import Table
from casacore import tables

from tests.arrays import EIGHT_ANTENNAS
from tests.cli.processes import started, wait_for
from uvshear.cli.application import run

OUTPUTS = ("s.fits", "s.stats.fits", "s.sky.fits")
CATALOGUE = "--field-arcmin 2 --count 12 --flux-ujy 30 200 --declination-deg -30 --seed 1 -o"
OBSERVATION = (
    "--declination-deg -30 --hours 4 --integration-s 600 --band-mhz 950 1190 --snr-at 30 10"
)
KEPT = "--keep moments --threads 2"


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small field, and its shapes without an interruption."""
    directory = tmp_path_factory.mktemp("resume")
    (directory / "array.txt").write_text(EIGHT_ANTENNAS)
    catalogue, field = directory / "cat.fits", directory / "field.ms"
    assert run(["catalogue", *CATALOGUE.split(), str(catalogue)]) == 0
    layout = ["--layout", str(directory / "array.txt"), "--catalogue", str(catalogue)]
    assert run(["simulate", *layout, *OBSERVATION.split(), "--seed", "1", "-o", str(field)]) == 0
    assert run(_words(directory, directory / "s.fits")) == 0
    return directory


def _words(inputs: Path, output: Path, *more: str) -> list[str]:
    words = ["measure", str(inputs / "field.ms"), "--catalogue", str(inputs / "cat.fits")]
    return [*words, *KEPT.split(), "-o", str(output), *more]


def _end(inputs: Path, output: Path, number: signal.Signals, there: str) -> str:
    """End a measurement as soon as its checkpoint has a file, and return what it says."""
    with started(*_words(inputs, output)) as running:
        wait_for(lambda: list(output.parent.glob(f"*.checkpoint/{there}")))
        running.send_signal(number)
        _, told = running.communicate(timeout=30)
        assert running.returncode == (-number if number == signal.SIGKILL else 128 + number)
        return told


def _content(path: Path) -> list[bytes]:
    table = Table.read(path)
    return [np.asarray(table[name]).tobytes() for name in table.colnames]


@pytest.mark.parametrize(
    ("number", "there"),
    [
        (signal.SIGTERM, "about.json"),
        (signal.SIGKILL, "extraction.sky.state"),
        (signal.SIGTERM, "extraction.sky.state"),
        (signal.SIGINT, "extraction.release.sky.state"),
        (signal.SIGKILL, "extraction.release.sky.state"),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_a_measurement_that_was_ended_is_resumed_to_the_same_bits(
    inputs: Path, tmp_path: Path, uvshear: Callable, number: signal.Signals, there: str
) -> None:
    output = tmp_path / "s.fits"
    told = _end(inputs, output, number, there)
    checkpoint = tmp_path / "s.checkpoint"
    if number != signal.SIGKILL:
        left = f"; the state of the measurement is in {checkpoint}: run the same command with --resume to go on from it"
        has_state = bool(list(checkpoint.glob("*.state")))
        interrupted = "uvshear: interrupted; unfinished outputs have been removed"
        assert told == f"{interrupted}{left * has_state}\n"
    left = [path for path in tmp_path.iterdir() if ".uvshear-unfinished-" not in path.name]
    assert left == [checkpoint]
    resumed = uvshear(*_words(inputs, output, "--resume"))
    assert resumed.status == 0, resumed.err
    if there != "about.json":  # otherwise it may or may not have stored more
        assert "begins anew" not in resumed.err
    assert sorted(os.listdir(tmp_path)) == sorted(OUTPUTS)
    for name in OUTPUTS:
        assert _content(tmp_path / name) == _content(inputs / name)


def test_results_are_stored_when_the_batch_system_ends_the_run(
    inputs: Path, tmp_path: Path
) -> None:
    """Statistics that were found within the last minute are not lost."""
    _end(inputs, tmp_path / "s.fits", signal.SIGTERM, "extraction.release.sky.state")
    stored = {path.name for path in (tmp_path / "s.checkpoint").iterdir()}
    assert "extraction.posteriors.000000.results" in stored


@pytest.fixture(scope="module")
def ended(inputs: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Directory with the checkpoint of a measurement that was killed."""
    directory = tmp_path_factory.mktemp("ended")
    _end(inputs, directory / "s.fits", signal.SIGKILL, "extraction.sky.state")
    return directory


@pytest.fixture
def copied(ended: Path, tmp_path: Path) -> Path:
    shutil.copytree(ended / "s.checkpoint", tmp_path / "s.checkpoint")
    return tmp_path


def _refused(uvshear: Callable, directory: Path, *words: str) -> str:
    """Return the message of a run that is refused, after the check that the checkpoint stays."""
    before = sorted(os.listdir(directory / "s.checkpoint"))
    outcome = uvshear(*words)
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1
    assert sorted(os.listdir(directory / "s.checkpoint")) == before
    assert not (directory / "s.fits").exists()
    return outcome.err


def test_other_options_are_refused_by_name(inputs: Path, copied: Path, uvshear: Callable) -> None:
    output = copied / "s.fits"
    told = _refused(uvshear, copied, *_words(inputs, output, "--resume", "--uv-min", "900"))
    assert "--uv-min was not given in the earlier run and is 900.0 now" in told
    told = _refused(uvshear, copied, *_words(inputs, output, "--resume", "--no-smearing"))
    assert "--smearing was True in the earlier run and is False now" in told


def test_other_inputs_are_refused_by_name(inputs: Path, copied: Path, uvshear: Callable) -> None:
    shutil.copytree(inputs / "field.ms", copied / "field.ms")
    table = Table.read(inputs / "cat.fits")
    table["flux"][3] *= 1.5
    table.meta = {}
    table.write(copied / "cat.fits")
    words = _words(inputs, copied / "s.fits", "--resume")
    words[words.index("--catalogue") + 1] = str(copied / "cat.fits")
    assert "the catalogue was 12 sources" in _refused(uvshear, copied, *words)
    words = _words(inputs, copied / "s.fits", "--resume")
    words[1] = str(copied / "field.ms")
    told = f"the earlier run did not have the content of {copied / 'field.ms'}, which is"
    assert told in _refused(uvshear, copied, *words)


def test_visibilities_that_have_changed_are_refused(
    inputs: Path, tmp_path: Path, uvshear: Callable
) -> None:
    for name in ("field.ms", "cat.fits"):
        copy = shutil.copytree if (inputs / name).is_dir() else shutil.copy
        copy(inputs / name, tmp_path / name)
    _end(tmp_path, tmp_path / "s.fits", signal.SIGKILL, "extraction.sky.state")
    with tables.table(str(tmp_path / "field.ms"), readonly=False, ack=False) as main:
        main.putcell("DATA", 0, main.getcell("DATA", 0) * 2)
    told = _refused(uvshear, tmp_path, *_words(tmp_path, tmp_path / "s.fits", "--resume"))
    assert f"the content of {tmp_path / 'field.ms'} was" in told


def test_another_version_is_refused(
    inputs: Path, copied: Path, uvshear: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("uvshear.pipeline.identity.version", lambda name: "9.9")
    told = _refused(uvshear, copied, *_words(inputs, copied / "s.fits", "--resume"))
    assert "the version of uvshear was 0.2" in told
    assert "is 9.9 now" in told


def test_a_damaged_checkpoint_is_refused(inputs: Path, copied: Path, uvshear: Callable) -> None:
    path = copied / "s.checkpoint" / "extraction.sky.state"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    told = _refused(uvshear, copied, *_words(inputs, copied / "s.fits", "--resume"))
    assert "extraction.sky.state: this part of a checkpoint is damaged" in told


def test_memory_and_threads_may_change(inputs: Path, copied: Path, uvshear: Callable) -> None:
    """A run that was killed for lack of memory goes on with less."""
    words = _words(inputs, copied / "s.fits", "--resume", "--memory-gb", "1")
    words[words.index("--threads") + 1] = "1"
    assert uvshear(*words).status == 0
    assert _content(copied / "s.stats.fits") == _content(inputs / "s.stats.fits")


def test_without_resume_the_measurement_begins_anew(
    inputs: Path, copied: Path, uvshear: Callable
) -> None:
    for path in (copied / "s.checkpoint").glob("*.state"):
        path.write_bytes(b"nobody reads this")
    outcome = uvshear(*_words(inputs, copied / "s.fits"))
    assert outcome.status == 0, outcome.err
    assert sorted(os.listdir(copied)) == sorted(OUTPUTS)


def test_a_run_without_a_checkpoint_begins_anew_and_says_so(
    inputs: Path, tmp_path: Path, uvshear: Callable
) -> None:
    outcome = uvshear(*_words(inputs, tmp_path / "s.fits", "--resume"))
    assert outcome.status == 0
    told = "s.checkpoint: there is no checkpoint; the measurement begins anew\n"
    assert outcome.err.startswith("uvshear: note: ")
    assert told in outcome.err
    # Provenance does not tell how often a run was ended.
    assert '"resume"' not in str(Table.read(tmp_path / "s.fits").meta)


def test_a_wrong_input_leaves_the_checkpoint_of_an_earlier_run(
    inputs: Path, copied: Path, uvshear: Callable
) -> None:
    words = _words(inputs, copied / "s.fits")
    words[words.index("--catalogue") + 1] = str(copied / "missing.fits")
    _refused(uvshear, copied, *words)
