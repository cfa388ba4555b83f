"""Time to simulate a million rows of 100 galaxies into a Measurement Set.

python benchmarks/simulate.py [--rows 1000000] [--galaxies 100]
"""

import argparse
import math
import tempfile
import time
from pathlib import Path

import numpy as np

import uvshear
from uvshear.constants import ARCMIN
from uvshear.execution import in_threads
from uvshear.galaxy import DiscEllipticityPrior, PowerLawFlux, SizeFluxRelation
from uvshear.interferometer import Channels, ObservingPlan, PhaseCentre, Track, load_layout
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.io.measurement_set.writer import write_measurement_set
from uvshear.simulation.population import Population, draw_population
from uvshear.simulation.sky_region import SquareField

BASELINES = 197 * 196 // 2


def main() -> None:
    """Simulate once to compile, once to time."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--galaxies", type=int, default=100)
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    for label, rows in (("compiling", BASELINES), ("timed", arguments.rows)):
        wall, cpu = time.perf_counter(), time.process_time()
        written = run(rows, arguments.galaxies, arguments.threads)
        print(
            f"{label}: {written} rows x {arguments.galaxies} galaxies,"
            f" {time.perf_counter() - wall:.1f} s wall, {time.process_time() - cpu:.1f} s CPU"
        )


def run(rows: int, galaxies: int, threads: int) -> int:
    centre = PhaseCentre(0.0, math.radians(-30))
    population = Population(PowerLawFlux(), SizeFluxRelation(), DiscEllipticityPrior())
    sky = draw_population(
        population, SquareField(6 * ARCMIN), number=galaxies, rng=np.random.default_rng(1)
    )
    samples = math.ceil(rows / BASELINES)
    track = Track.from_clock(centre, ((-14400.0, 14400.0),), 28800.0 / samples)
    plan = ObservingPlan(load_layout("ska-mid-aa4"), track, Channels.from_band(0.95e9, 1.19e9, 1))
    observation = uvshear.simulate(
        catalogue_from_galaxies(sky, centre), plan, seed=1, executor=in_threads(threads)
    )
    with tempfile.TemporaryDirectory() as folder:
        write_measurement_set(Path(folder) / "field.ms", observation, executor=in_threads(threads))
    return len(observation.coverage)


if __name__ == "__main__":
    main()
