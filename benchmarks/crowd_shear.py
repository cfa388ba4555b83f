"""Bias of every estimator of the shear in a crowded field, extracted whole; SKA-Mid AA4, 8 h.

    python benchmarks/crowd_shear.py --density 2.8 --galaxies 1120 --shear 0.03 --table crowd.ecsv
    python benchmarks/crowd_shear.py --density 1 2.8 5 8 --galaxies 400 --shear 0 --table crowd.ecsv

The galaxies of one field are behind g and -g (or behind none), with e and -e, with noise and its opposite: four
extractions for each shear, which serve all estimators. ``crowd_shear_figure.py`` draws the shear that is found without
any against the density.
"""

import argparse
import time
from pathlib import Path

from astropy.table import Table, vstack
from survey import PHASE_CENTRE

import uvshear
from uvshear.bias import opposite_shears
from uvshear.bias.crowded import estimate_crowded_bias
from uvshear.estimators import estimator_of
from uvshear.execution import in_threads
from uvshear.galaxy import Galaxies
from uvshear.interferometer.visibilities import VisibilitySet
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.progress import Progress


def main() -> None:
    """Simulate, extract, print, add to the table."""
    arguments = parse()
    rows = []
    for density in arguments.density:
        start = time.perf_counter()
        found = measured(arguments, density)
        seconds = time.perf_counter() - start
        about = {"density": density, "shear": arguments.shear, "seed": arguments.seed}
        for name, bias in zip(arguments.estimator, found, strict=True):
            for part in (bias, *bias.bins):
                print(f"{density:g} {name} {part}", flush=True)
                row = {"estimator": name, **about, "flux": part.name, **part.record()}
                rows.append({**row, "s": seconds})
    table = Table(rows)
    if arguments.table:
        known = [Table.read(arguments.table)] if arguments.table.exists() else []
        vstack([*known, table]).write(arguments.table, overwrite=True)


def measured(arguments: argparse.Namespace, density: float) -> list:
    """Return the bias of each estimator."""
    resources = uvshear.Resources(executor=in_threads(arguments.threads))
    track = uvshear.Track.from_clock(PHASE_CENTRE, ((-14400.0, 14400.0),), arguments.integration_s)
    channels = uvshear.Channels.from_band(950e6, 1190e6, 1)
    plan = uvshear.ObservingPlan(uvshear.load_layout("ska-mid-aa4"), track, channels)
    survey = uvshear.Survey(plan, snr_min=10.0)
    crowd = survey.crowd(
        opposite_shears(arguments.shear),
        arguments.galaxies,
        density,
        arguments.seed,
        resources.executor,
    )
    estimators = [estimator_of(name) for name in arguments.estimator]

    def measure(
        observation: VisibilitySet, lensed: Galaxies, _: Progress | None
    ) -> uvshear.Measurement:
        catalogue = catalogue_from_galaxies(lensed, observation.phase_centre)
        return uvshear.measure(observation, catalogue, keep=estimators, resources=resources)

    def show(done: int, count: int) -> None:
        print(f"{density:g}: extraction {done} of {count}", flush=True)

    return list(estimate_crowded_bias(crowd, estimators, measure, show))


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
