"""Time of ``uvshear simulate`` for a square degree, and with the losses of a correlator and of dishes; and its errors.

python benchmarks/simulation_cost.py [--record simulation_cost]
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from casacore import tables
from record import RESULTS, write_record

TELESCOPE = "--layout ska-mid-aa4 --declination-deg -30 --band-mhz 950 1190 --snr-at 10 10 --seed 1"

SQUARE_DEGREE = "--field-arcmin 60 --density 2.8 --flux-ujy 10 200 --seed 7"
NIGHT = f"{TELESCOPE} --hours 8 --integration-s 60 --channels 1"

LOSSES = "--field-arcmin 20 --count 1000 --flux-ujy 10 200 --seed 7"
WITH_LOSSES = (
    f"{TELESCOPE} --hours 0.05 --integration-s 60 --channels 64 --smearing --primary-beam airy"
)


def main() -> None:
    """Simulate each case, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for case, sky, observation in (
            ("square_degree", SQUARE_DEGREE, NIGHT),
            ("losses", LOSSES, WITH_LOSSES),
        ):
            catalogue = folder / f"{case}.fits"
            uvshear("catalogue", *sky.split(), "-o", catalogue)
            words = [*observation.split(), "--threads", arguments.threads]
            figures |= {
                f"{case}_{figure}": value
                for figure, value in timed(folder / f"{case}.ms", catalogue, words).items()
            }
        exact = timed(folder / "exact.ms", folder / "losses.fits", [*words, "--exact"])
        figures["losses_exact_cpu_s"] = exact["cpu_s"]
        error = error_over_noise(folder / "losses.ms", folder / "exact.ms")
        figures["losses_error_over_noise"] = error
    sums = 1000 * figures["losses_visibilities"]
    figures["losses_ns"] = 1e9 * figures["losses_cpu_s"] / sums
    for figure, value in figures.items():
        print(f"{figure}: {value:.4g}")
    if arguments.record:
        write_record(
            RESULTS / f"{arguments.record}.json",
            figures,
            [7, 1],
            title=(
                "uvshear simulate: 10 080 galaxies in a square degree, 9.27 million rows; 1000 galaxies in 20 arcmin"
                f" with a primary beam and averaging in 64 channels; {arguments.threads} threads."
            ),
        )


def uvshear(*words: object) -> None:
    subprocess.run([sys.executable, "-m", "uvshear", *map(str, words)], check=True)


def timed(path: Path, catalogue: Path, words: list[object]) -> dict[str, float]:
    """Simulate a set; return the time that it took and its number of visibilities."""
    before, wall = os.times(), time.perf_counter()
    uvshear("simulate", "--catalogue", catalogue, *words, "-o", path)
    wall, after = time.perf_counter() - wall, os.times()
    cpu = (after.children_user - before.children_user) + (
        after.children_system - before.children_system
    )
    with tables.table(str(path), ack=False) as main_table:
        rows, channels = main_table.nrows(), len(main_table.getcell("DATA", 0))
    return {"wall_s": wall, "cpu_s": cpu, "visibilities": rows * channels}


def error_over_noise(path: Path, exact: Path) -> float:
    """Rms difference of one component of a visibility of one hand, over the noise."""
    with tables.table(str(path), ack=False) as one, tables.table(str(exact), ack=False) as other:
        difference = one.getcol("DATA") - other.getcol("DATA")
        sigma = float(np.mean(one.getcell("SIGMA_SPECTRUM", 0)))
    return float(np.sqrt(np.mean(np.abs(difference) ** 2) / 2)) / sigma


if __name__ == "__main__":
    main()
