"""Measurements that are killed at random moments and resumed: their shapes, and the work that is done twice.

    python benchmarks/resume.py [--kills 25] [--field-arcmin 12 --count 403] [--record resume]

A field is simulated and measured once without an interruption. Then each measurement gets SIGKILL or, every fifth
time, SIGTERM at a random moment, and is resumed until it ends. The log of each run (``measure --log``) tells which
stages were finished and which were begun.
"""

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from astropy.table import Table
from record import RESULTS, write_record

OBSERVATION = (
    "--layout ska-mid-aa4 --declination-deg -30 --hours 8 --integration-s 900 --band-mhz 950 1190 --channels 1"
    " --snr-at 10 10 --seed 1"
)
OUTPUTS = ("", ".stats", ".sky")
CYCLES = ("major cycle", "minor cycle")


@dataclass(frozen=True)
class Ended:
    """A run that has ended: its exit status, the time that it took, and that of each finished stage [s]."""

    status: int
    seconds: float
    stages: Mapping[str, float]


def main() -> None:
    """Simulate, measure, kill, resume, compare, write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--kills", type=int, default=25)
    parser.add_argument("--field-arcmin", type=float, default=12.0)
    parser.add_argument("--count", type=int, default=403)
    parser.add_argument("--keep", default="moments")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        figures = measured(Path(name), arguments)
    for figure, value in figures.items():
        print(f"{figure}: {value:.4g}")
    if arguments.record:
        write_record(
            RESULTS / f"{arguments.record}.json",
            figures,
            [arguments.seed],
            title=(
                f"Measurements of {arguments.count} galaxies in {arguments.field_arcmin:g} arcmin that are killed at"
                f" random moments and resumed; {arguments.threads} threads."
            ),
        )


def measured(folder: Path, arguments: argparse.Namespace) -> dict[str, float]:
    """Return the figures of all kills."""
    run_command(
        f"catalogue --field-arcmin {arguments.field_arcmin} --count {arguments.count} --seed 1 -o cat.fits",
        folder,
    )
    run_command(f"simulate {OBSERVATION} --catalogue cat.fits -o field.ms", folder)
    words = (
        f"measure field.ms --catalogue cat.fits --keep {arguments.keep} --threads {arguments.threads}"
        " --overwrite --log run.log -o shapes.fits"
    )
    measure(words, folder)  # compiles the kernels
    whole = measure(words, folder)
    expected = content(folder)
    moments = random.Random(arguments.seed)
    differing, twice, cycles_twice, sizes = 0, [], [], []
    for number in range(arguments.kills):
        moment = moments.uniform(0, whole.seconds)
        kind = signal.SIGTERM if number % 5 == 4 else signal.SIGKILL
        (folder / "run.log").unlink()  # a run that is killed at once leaves none
        first = measure(words, folder, after=moment, kind=kind)
        if first.status == 0:
            continue  # it was faster than the moment
        there = list((folder / "shapes.checkpoint").glob("*"))
        sizes.append(sum(path.stat().st_size for path in there) / 1e6)
        again = measure(f"{words} --resume", folder)
        assert again.status == 0
        assert not (folder / "shapes.checkpoint").exists()
        differing += content(folder) != expected
        both = first.stages.keys() & again.stages.keys()
        cycles_twice.append(sum(stage.startswith(CYCLES) for stage in both))
        twice.append(first.seconds + again.seconds - whole.seconds)
        print(f"{number}: killed after {moment:.1f} s, {twice[-1]:.1f} s more in all", flush=True)
    return {
        "kills": len(twice),
        "differing": differing,
        "whole_s": whole.seconds,
        "longest_cycle_s": max(
            seconds for stage, seconds in whole.stages.items() if stage.startswith(CYCLES)
        ),
        "cycles_twice_max": max(cycles_twice),
        "twice_max_s": max(twice),
        "twice_median_s": float(np.median(twice)),
        "checkpoint_max_mb": max(sizes),
    }


def measure(
    words: str,
    folder: Path,
    after: float | None = None,
    kind: signal.Signals = signal.SIGKILL,
) -> Ended:
    """Run a measurement, and end it after some time."""
    begin = time.monotonic()
    process = subprocess.Popen(
        [sys.executable, "-m", "uvshear", *words.split()],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        process.communicate(timeout=after)
    except subprocess.TimeoutExpired:
        process.send_signal(kind)
        process.communicate()
    seconds = time.monotonic() - begin
    return Ended(process.returncode, seconds, stages(folder / "run.log"))


def stages(log: Path) -> dict[str, float]:
    """Return the duration of each stage that the last run of a log has finished [s], by its name."""
    found: dict[str, float] = {}
    if not log.exists():
        return found
    for record in map(json.loads, log.read_text(encoding="utf-8").splitlines()):
        if record["record"] == "run":
            found.clear()  # a resumed run appends its lines
        elif record["record"] == "stage" and record.get("finished", True):
            found[record["stage"]] = record["seconds"]
    return found


def content(folder: Path) -> Sequence[bytes]:
    """Return all values of the tables of a measurement, bit for bit."""
    tables = [Table.read(folder / f"shapes{kind}.fits") for kind in OUTPUTS]
    return [np.asarray(table[name]).tobytes() for table in tables for name in table.colnames]


def run_command(words: str, folder: Path) -> None:
    """Run a command that must succeed."""
    subprocess.run([sys.executable, "-m", "uvshear", *words.split()], check=True, cwd=folder)


if __name__ == "__main__":
    main()
