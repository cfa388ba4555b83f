"""The logs of commands."""

import json
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.cli.processes import started, wait_for
from uvshear.io.shapes import read_shapes

SIMULATE = (
    "simulate --declination-deg -30 --hours 1 --integration-s 600 --band-mhz 950 1190"
    " --snr-at 10 50 --catalogue CAT --layout LAYOUT -o new.ms --log run.log"
)
COMMANDS = {
    "measure": (
        "measure FIELD --catalogue CAT --keep moments -o s.fits --residual-image i.fits --log run.log",
        ("first pass", "major cycle 1", "minor cycle 1", "statistics", "residual image"),
    ),
    "simulate": (SIMULATE, ("coverage", "preparation", "prediction", "writing")),
    "average": ("average FIELD --field-arcmin 4 -o a.ms --log run.log", ("averaging", "writing")),
    "bias": (
        "bias --estimator moments --galaxies 100 --integration-s 3600 -o b.json --log run.log",
        ("first guess", "galaxies"),
    ),
}


@pytest.fixture
def run(
    uvshear: Callable,
    tmp_path: Path,
    field: Path,
    catalogue: Path,
    layout: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Callable:
    """Return a function that runs a command in a directory that only its outputs and inputs are in."""
    monkeypatch.chdir(tmp_path)
    places = {"FIELD": field.name, "CAT": catalogue.name, "LAYOUT": layout.name}
    return lambda words: uvshear(*(places.get(word, word) for word in words.split()))


def lines() -> list[dict]:
    return [json.loads(line) for line in Path("run.log").read_text().splitlines()]


@pytest.mark.parametrize("name", COMMANDS)
def test_a_log_tells_of_every_stage(run: Callable, name: str) -> None:
    words, expected = COMMANDS[name]
    outcome = run(words)
    assert outcome.status == 0, outcome.err
    first, *stages, last = lines()
    assert first["record"] == "run"
    assert first["command"] == f"uvshear {name}"
    assert [each["record"] for each in stages] == ["stage"] * len(stages)
    names = [each["stage"] for each in stages]
    assert [each for each in names if each in expected] == list(expected)
    assert all(each["seconds"] >= 0 and each["peak_memory_bytes"] > 1e7 for each in stages)
    assert (last["record"], last["outcome"]) == ("end", "finished")
    assert last["seconds"] >= sum(each["seconds"] for each in stages) - 0.01
    if name == "measure":
        assert first["inputs"] == ["field.ms", "cat.ecsv"]
        minor = next(each for each in stages if each["stage"] == "minor cycle 1")
        assert minor["change_rms"] > 0


def test_a_log_changes_no_other_output(run: Callable) -> None:
    measure = "measure FIELD --catalogue CAT --extraction paper -o s.ecsv"
    assert run(measure).status == 0
    before = read_shapes(Path("s.ecsv"))
    assert run(f"{measure} --overwrite --log run.log").status == 0
    after = read_shapes(Path("s.ecsv"))
    assert after.meta["options"] == before.meta["options"]
    assert all(np.array_equal(after[name], before[name]) for name in ("e1", "e2", "flux_fit"))


@pytest.mark.parametrize("name", COMMANDS)
def test_a_log_that_exists_is_refused_before_the_work(run: Callable, name: str) -> None:
    Path("run.log").write_text("precious\n")
    outcome = run(COMMANDS[name][0])
    assert outcome.status == 2
    assert outcome.err.startswith("uvshear: error: run.log: exists already; give --overwrite")
    assert outcome.err.count("\n") == 1
    assert Path("run.log").read_text() == "precious\n"
    assert run(f"{COMMANDS[name][0]} --overwrite").status == 0
    assert lines()[-1]["outcome"] == "finished"


@pytest.mark.parametrize(
    ("log", "message"),
    [
        ("s.fits", "s.fits: would be written twice; give two names"),
        ("s.sky.fits", "s.sky.fits: would be written twice; give two names"),
        ("cat.ecsv", "cat.ecsv: exists already"),
        ("cat.ecsv --overwrite", "cat.ecsv: is an input too; give another name for the output"),
        ("field.ms/log", "field.ms/log: is within the input field.ms; give another name"),
        ("no/run.log", "no/run.log: no does not exist; give an output in a directory that exists"),
        (".", ".: exists already"),
        (". --overwrite", ".: is a directory; give the name of a file"),
    ],
)
def test_a_log_that_cannot_be_written_is_refused_in_one_line(
    run: Callable, log: str, message: str
) -> None:
    inputs = {path: path.read_bytes() for path in (Path("cat.ecsv"), Path("field.ms/table.dat"))}
    outcome = run(f"measure FIELD --catalogue CAT -o s.fits --log {log}")
    assert outcome.status == 2
    assert outcome.err.startswith(f"uvshear: error: {message}")
    assert outcome.err.count("\n") == 1
    assert not Path("s.fits").exists()
    assert all(path.read_bytes() == content for path, content in inputs.items())


def test_a_run_that_fails_says_why_in_its_log(run: Callable) -> None:
    table = Path("cat.ecsv").read_text()
    Path("cat.ecsv").write_text(table.replace("0.0001 0 50", "0.9 0 50").replace("-0.0002", "0.9"))
    Path("cat.ecsv").write_text("\n".join(Path("cat.ecsv").read_text().splitlines()[:-1]) + "\n")
    outcome = run("measure FIELD --catalogue CAT -o s.fits --log run.log")
    assert outcome.status == 2
    reason = outcome.err.splitlines()[-1].removeprefix("uvshear: error: ")
    end = lines()[-1]
    assert (end["record"], end["outcome"]) == ("end", "failed")
    assert end["message"] == f"InputError: {reason}"


@pytest.mark.parametrize(
    ("number", "outcome"),
    [(signal.SIGINT, "interrupted"), (signal.SIGTERM, "interrupted"), (signal.SIGKILL, None)],
)
def test_a_log_tells_how_far_a_run_came_that_was_ended(
    tmp_path: Path, number: signal.Signals, outcome: str | None
) -> None:
    path = tmp_path / "run.log"
    words = "bias --estimator moments --shear 0.02 --galaxies 100000 --threads 2 -o"
    with started(*words.split(), tmp_path / "bias.json", "--log", path) as running:
        wait_for(lambda: path.exists() and '"preparation"' in path.read_text())
        running.send_signal(number)
        running.communicate(timeout=30)
    found = [json.loads(line) for line in path.read_text().splitlines()]
    assert [each["record"] for each in found[:2]] == ["run", "stage"]
    assert (found[-1].get("outcome") if outcome else None) == outcome
    assert len(found) == (4 if outcome else 2)
    unfinished = [each["stage"] for each in found if each.get("finished") is False]
    assert unfinished == ([found[2]["stage"]] if outcome else [])
