"""The log of a run."""

import json
import os
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from uvshear.errors import InputError
from uvshear.execution.usage import Usage
from uvshear.io import run_log as module
from uvshear.io.provenance import Provenance
from uvshear.io.run_log import RunLog, end_open_logs, run_log
from uvshear.progress import Meter, Stage

MADE = Provenance("uvshear measure", ("field.ms",), {"uv_min": 3.0})
COST = 1e9


def log_at(path, told=None, *, overwrite=False):
    """Open a log; ``told`` is the list of what it could not write."""
    return run_log(path, MADE, overwrite=overwrite, on_failure=(told or []).append)


def lines(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def work(log):
    """Report two stages."""
    meter = Meter(log)
    meter.begin(Stage("fits", COST, 4.0, "galaxies"), Stage("rest"))
    meter.add(2)
    end = time.process_time() + 0.1
    while time.process_time() < end:
        pass
    meter.add(2)
    meter.note(change_rms=0.5, moves=[[1.0, 0.5]])
    meter.begin(Stage("rest"))


def test_a_run_has_a_line_for_each_stage_and_for_its_end(tmp_path):
    path = tmp_path / "run.log"
    with log_at(path) as log:
        work(log)
    run, fits, rest, end = lines(path)
    assert [each["record"] for each in (run, fits, rest, end)] == ["run", "stage", "stage", "end"]
    assert (run["command"], run["inputs"]) == ("uvshear measure", ["field.ms"])
    assert run["options"] == {"uv_min": 3.0}
    assert run["process"] == os.getpid()
    assert run["cores"] >= 1
    assert run["machine_memory_bytes"] > 1e8
    assert (fits["stage"], fits["done"], fits["unit"]) == ("fits", 4, "galaxies")
    assert fits["seconds"] >= 0.1
    assert 0.05 < fits["cpu_seconds"] < 0.5
    assert fits["per_second"] == pytest.approx(4 / fits["seconds"], rel=0.01)
    assert fits["peak_memory_bytes"] > 1e7
    assert (fits["change_rms"], fits["moves"]) == (0.5, [[1.0, 0.5]])
    assert rest["start"] == pytest.approx(fits["start"] + fits["seconds"], abs=0.1)
    assert "change_rms" not in rest
    assert "done" not in rest
    assert "finished" not in fits | rest
    assert end["outcome"] == "finished"
    assert end["seconds"] >= rest["start"] + rest["seconds"] - 0.01
    assert end["peak_memory_bytes"] >= fits["peak_memory_bytes"]


def test_memory_that_is_given_back_within_a_stage_counts(tmp_path):
    path = tmp_path / "run.log"
    with log_at(path) as log:
        meter = Meter(log)
        meter.begin(Stage("large"))
        usage = Usage.now()
        size = usage.peak - usage.memory + 2e8
        np.ones(int(size / 8))
        meter.begin(Stage("small"))
    _, large, small, end = lines(path)
    assert large["peak_memory_bytes"] > usage.peak + 1e8
    assert small["peak_memory_bytes"] < usage.memory + 1e8
    assert end["peak_memory_bytes"] == large["peak_memory_bytes"]


def test_what_is_known_is_in_the_file_before_the_run_ends(tmp_path):
    path = tmp_path / "run.log"
    with log_at(path) as log:
        assert [each["record"] for each in lines(path)] == ["run"]
        work(log)
        assert [each.get("stage") for each in lines(path)] == [None, "fits"]


def test_a_long_stage_has_lines_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "EVERY", 0.05)
    monkeypatch.setattr(module, "SAMPLED_EVERY", 0.0)
    path = tmp_path / "run.log"
    with log_at(path) as log:
        work(log)
    (progress,) = [each for each in lines(path) if each["record"] == "progress"]
    assert (progress["stage"], progress["share"]) == ("fits", 1.0)
    assert progress["seconds"] >= 0.1
    assert progress["memory_bytes"] > 1e7


@pytest.mark.parametrize(
    ("error", "outcome", "message"),
    [
        (InputError("CAT.fits: has\nno rows"), "failed", "InputError: CAT.fits: has no rows"),
        (MemoryError("2 bytes"), "failed", "MemoryError: 2 bytes"),
        (KeyboardInterrupt(), "interrupted", None),
    ],
)
def test_the_end_of_a_run_that_fails_is_told(tmp_path, error, outcome, message):
    path = tmp_path / "run.log"

    def run():
        with log_at(path) as log:
            work(log)
            raise error

    with pytest.raises(type(error)):
        run()
    *_, fits, rest, end = lines(path)
    assert rest["stage"] == "rest"
    assert (rest["finished"], "finished" in fits) == (False, False)
    assert (end["outcome"], end.get("message")) == (outcome, message)


def test_a_stage_that_is_cut_short_is_not_finished(tmp_path):
    def run(log):
        meter = Meter(log)
        meter.begin(Stage("fits", COST, 4.0, "galaxies"))
        meter.add(1)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), log_at(tmp_path / "run.log") as log:
        run(log)
    _, fits, _ = lines(tmp_path / "run.log")
    assert (fits["done"], fits["finished"], fits["share"]) == (1, False, 0.25)


def test_a_file_that_exists_is_replaced_only_if_asked_for(tmp_path):
    path = tmp_path / "run.log"
    path.write_text("precious\n" * 1000)
    with pytest.raises(InputError, match="exists already"), log_at(path):
        pass
    assert path.read_text().startswith("precious")
    with log_at(path, overwrite=True):
        pass
    assert [each["record"] for each in lines(path)] == ["run", "end"]


def test_a_log_that_cannot_be_written_is_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"), log_at(tmp_path / "no" / "run.log"):
        pass
    with pytest.raises(InputError, match="is a directory"), log_at(tmp_path, overwrite=True):
        pass
    circle = tmp_path / "circle"
    circle.symlink_to(circle)
    with (
        pytest.raises(InputError, match="circle: cannot be written: Too many levels"),
        log_at(circle, overwrite=True),
    ):
        pass


def test_a_full_disk_ends_the_log_and_not_the_run(tmp_path):
    told = []
    with suppress(OSError), Path("/dev/full").open("w", encoding="utf-8") as full:
        log = RunLog(tmp_path / "run.log", full, told.append)
        work(log)
        log.write_end(None)
    reason = "cannot be written any more (No space left on device); the run goes on without a log"
    assert told == [f"{tmp_path / 'run.log'}: {reason}"]


def test_a_run_that_continues_another_appends_to_its_log(tmp_path):
    path = tmp_path / "run.log"
    for _ in range(2):
        with run_log(path, MADE, overwrite=True, appends=True, on_failure=[].append) as log:
            work(log)
    kinds = ["run", "stage", "stage", "end"]
    assert [each["record"] for each in lines(path)] == 2 * kinds


def test_lines_are_not_appended_to_what_is_no_log(tmp_path):
    path = tmp_path / "run.log"
    path.write_text('{"record": "galaxies"}\n')
    appended = run_log(path, MADE, overwrite=False, appends=True, on_failure=[].append)
    with pytest.raises(InputError, match="exists already"), appended:
        pass
    assert path.read_text() == '{"record": "galaxies"}\n'
    with run_log(path, MADE, overwrite=True, appends=True, on_failure=[].append):
        pass
    assert [each["record"] for each in lines(path)] == ["run", "end"]


def test_logs_that_are_open_when_the_process_ends_tell_of_the_interruption(tmp_path):
    path = tmp_path / "run.log"
    with log_at(path) as log:
        work(log)
        end_open_logs()
        at_the_end = lines(path)
    assert [each["record"] for each in at_the_end] == ["run", "stage", "stage", "end"]
    assert at_the_end[-1]["outcome"] == "interrupted"
    assert at_the_end[-2]["finished"] is False
    # Nothing is added by the end of the run itself, nor to the logs of runs that have ended.
    end_open_logs()
    assert lines(path) == at_the_end
