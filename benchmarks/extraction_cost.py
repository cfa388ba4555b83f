"""What the extraction costs, on SKA-Mid AA4 over 8 h: growth with rows and with sources, and a profile.

    python benchmarks/extraction_cost.py --grid
    python benchmarks/extraction_cost.py --against-gridder
    python benchmarks/extraction_cost.py --profile

``--against-gridder``: CPU time of 0.93 million rows and 101 sources over that of one w-gridder pass over the same
field (2400^2 pixels of 0.15 arcsec, epsilon 1e-4), both in this process, compilation aside.
"""

import argparse
import cProfile
import json
import math
import pstats
import time

import ducc0
import survey

import uvshear
from uvshear.constants import ARCSEC
from uvshear.io.catalogue import catalogue_from_galaxies
from uvshear.measurement import MeasurementOptions


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--grid", action="store_true")
    parser.add_argument("--against-gridder", action="store_true")
    parser.add_argument("--profile", action="store_true")
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    measure(field(3.0, 1800.0), arguments.threads)  # compiles
    if arguments.against_gridder:
        against_gridder(arguments.threads)
    if arguments.profile:
        profile()
    if arguments.grid:
        print("rows      sources  wall [s]  CPU [s]  visits")
        for side, integration in (
            *((6.0, seconds) for seconds in (1800.0, 600.0, 200.0, 60.0)),
            *((arcmin, 900.0) for arcmin in (3.0, 6.0, 12.0, 24.0)),
        ):
            world = field(side, integration)
            wall, cpu, visits = measure(world, arguments.threads)
            rows = sum(map(len, world[1].blocks))
            print(
                f"{rows:8d}  {len(world[0]):7d}  {wall:8.1f}  {cpu:7.1f}  {visits:6d}", flush=True
            )


def field(arcmin: float, integration: float):
    galaxies, observation, _ = survey.simulate(arcmin, 2.8, integration, seed=7, threads=2)
    return galaxies, observation


def measure(world, threads: int) -> tuple[float, float, int]:
    galaxies, observation = world
    catalogue = catalogue_from_galaxies(galaxies, survey.PHASE_CENTRE)
    wall, cpu = time.perf_counter(), time.process_time()
    shapes = uvshear.measure(observation, catalogue, MeasurementOptions(threads=threads))
    visits = json.loads(shapes.meta["extract"])["visits"]
    return time.perf_counter() - wall, time.process_time() - cpu, visits


def against_gridder(threads: int) -> None:
    world = field(6.0, 600.0)
    chunk = world[1].blocks[0]
    cpu = time.process_time()
    ducc0.wgridder.vis2dirty(
        uvw=chunk.uvw,
        freq=survey.FREQUENCY,
        vis=chunk.stokes_i,
        wgt=chunk.weights,
        npix_x=2400,
        npix_y=2400,
        pixsize_x=0.15 * ARCSEC,
        pixsize_y=0.15 * ARCSEC,
        epsilon=1e-4,
        do_wgridding=True,
        nthreads=threads,
    )
    gridder = time.process_time() - cpu
    _, extraction, visits = measure(world, threads)
    print(
        f"{len(chunk)} rows, {len(world[0])} sources: {extraction:.1f} s CPU in {visits} visits; "
        f"one pass of the gridder {gridder:.2f} s; ratio {extraction / gridder:.1f}"
    )


def profile() -> None:
    world = field(12.0, 600.0)
    profiler = cProfile.Profile()
    profiler.enable()
    measure(world, 1)
    profiler.disable()
    stats = pstats.Stats(profiler)
    total = stats.total_tt
    print(f"12 arcmin, {len(world[0])} sources, one thread: {total:.1f} s")
    rows = sorted(stats.stats.items(), key=lambda item: -item[1][2])[:16]
    for (file, _, name), (_, calls, own, _, _) in rows:
        where = "/".join(file.split("/")[-2:]) if math.isfinite(own) else file
        print(f"{100 * own / total:5.1f} %  {calls:7d} calls  {where} {name}")


if __name__ == "__main__":
    main()
