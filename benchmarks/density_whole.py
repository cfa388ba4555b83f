"""Slopes in the square degree of the paper by the paper's own way: the first part of ``uvshear reproduce density``.

    uvshear reproduce density --scale paper -o DIR          (the first part takes an hour of one core)
    python benchmarks/density_whole.py DIR --record density-whole

The part is read if the directory has it, and computed otherwise.
"""

import argparse
import time
from pathlib import Path

import numpy as np
from record import RESULTS, write_record

from uvshear.execution import single_threaded_libraries
from uvshear.io.part_files import PartFiles
from uvshear.reproduce.registry import targets_at
from uvshear.reproduce.shape_sample import ShapeSample

PART = "whole-0"


def main() -> None:
    """Read or compute the part, and write its slopes."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("directory", type=Path, help="directory of uvshear reproduce")
    parser.add_argument("--record", help="name of a record to write to benchmarks/results")
    arguments = parser.parse_args()
    (target,) = targets_at("paper", ("density",))
    store = PartFiles(arguments.directory / "parts" / target.name, {})
    if PART in store:
        part = store.load(PART)
    else:
        begin = time.process_time()
        with single_threaded_libraries():
            part = dict(target.measure(target.tasks()[PART]))
        part["seconds"] = np.array(time.process_time() - begin)
    sample = ShapeSample.join([part])
    figures = {"galaxies": float(len(sample)), "failed": float(np.sum(~sample.is_good))}
    if "seconds" in part:
        figures["cpu_s"] = float(part["seconds"])
    for number, slopes in enumerate(sample.slopes(), start=1):
        slope = slopes.inverse_variance
        figures |= {f"slope_e{number}": slope.value, f"slope_e{number}_err": slope.error}
    print(figures)
    if arguments.record:
        write_record(
            RESULTS / f"{arguments.record}.json",
            figures,
            [target.seed],
            title="Slopes by the paper's extraction for the whole square degree of the paper, 9.27 million samples.",
        )


if __name__ == "__main__":
    main()
