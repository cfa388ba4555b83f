"""Bias of every estimator of the shear in a crowded field, extracted whole; SKA-Mid AA4, 8 h.

    python benchmarks/crowd_shear.py --density 2.8 --galaxies 1120 --shear 0.03 --table crowd.ecsv
    python benchmarks/crowd_shear.py --density 1 2.8 5 8 --galaxies 400 --shear 0 --table crowd.ecsv

One field, its galaxies behind g and -g (or behind none), with e and -e, with noise and its opposite: four extractions a
shear, which serve all estimators. ``crowd_shear_figure.py`` draws what is left without shear against the density.
"""

import argparse
import cmath
import math
import time
from pathlib import Path

from astropy.table import Table, vstack
from survey import PHASE_CENTRE

from uvshear.bias.crowded import FieldBayesian, FieldMean, FieldMoments
from uvshear.bias.survey import Survey, calibrate_crowded
from uvshear.execution import in_threads
from uvshear.extraction import MeasurementOptions
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels


def main() -> None:
    """Simulate, extract, print, add to the table."""
    arguments = parse()
    rows = []
    for density in arguments.density:
        start = time.perf_counter()
        found = measured(arguments, density)
        seconds = time.perf_counter() - start
        about = {"density": density, "shear": arguments.shear, "seed": arguments.seed}
        for name, biases in found.items():
            for one in biases:
                print(f"{density:g} {name} {one.name}: {one.record()}", flush=True)
                rows.append(
                    {"estimator": name, **about, "flux": one.name, **one.record(), "s": seconds}
                )
    table = Table(rows)
    if arguments.table:
        known = [Table.read(arguments.table)] if arguments.table.exists() else []
        vstack([*known, table]).write(arguments.table, overwrite=True)


def measured(arguments: argparse.Namespace, density: float) -> dict:
    """Biases of each estimator, in total and by flux."""
    track = Track.from_clock(PHASE_CENTRE, ((-14400.0, 14400.0),), arguments.integration_s)
    plan = ObservingPlan(load_layout("ska-mid-aa4"), track, Channels.from_band(950e6, 1190e6, 1))
    g = cmath.rect(arguments.shear, math.pi / 4)
    survey = Survey(
        plan,
        (g, -g) if arguments.shear else (0j,),
        snr_min=10.0,
        seed=arguments.seed,
        executor=in_threads(arguments.threads),
    )
    crowd = survey.crowd(arguments.galaxies, density)
    known = {"mean": FieldMean(), "moments": FieldMoments(), "bayesian": FieldBayesian()}
    chosen = {name: known[name] for name in arguments.estimator}
    options = MeasurementOptions(executor=in_threads(arguments.threads))
    biases = calibrate_crowded(
        crowd,
        list(chosen.values()),
        options,
        lambda done, count: print(f"{density:g}: extraction {done} of {count}", flush=True),
    )
    return dict(zip(chosen, biases, strict=True))


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--density", type=float, nargs="+", default=[2.8])
    parser.add_argument("--galaxies", type=int, default=1120)
    parser.add_argument("--shear", type=float, default=0.03)
    parser.add_argument(
        "--estimator",
        nargs="+",
        choices=["mean", "moments", "bayesian"],
        default=["mean", "moments", "bayesian"],
    )
    parser.add_argument("--integration-s", type=float, default=900.0)
    parser.add_argument("--table", type=Path, help="ECSV to add the figures to")
    parser.add_argument("--seed", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    return parser.parse_args()


if __name__ == "__main__":
    main()
